// `sweepcast serve`: the main job. Reads the options, finds the lidars, runs the gateway until told
// to stop.
#include "driver/device/probe.hpp"
#include "driver/link/port_list.hpp"
#include "server/cli/command.hpp"
#include "server/cli/descriptors.hpp"
#include "server/cli/stop_signals.hpp"
#include "server/gateway/gateway.hpp"
#include "server/log/log.hpp"
#include "server/net/endpoint.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/asio/awaitable.hpp>
#include <fmt/format.h>
#include <google/protobuf/stubs/logging.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace sweepcast::cli {

namespace asio = boost::asio;

namespace {

struct ServeArguments {
    std::string http{"127.0.0.1:8080"};
    std::string tcp{"127.0.0.1:8081"};
    std::vector<std::string> lidars;
    std::string mode;
    bool idle{};
    std::size_t threads{1};
    std::string state_dir;
    std::string log_level{"info"};
};

constexpr const char* default_virtual = "virtual:a1m8";

/// Puts the ports where a lidar answers into `found`.
asio::awaitable<void> find_lidars(
    asio::any_io_executor executor,
    std::shared_ptr<spdlog::logger> log,
    std::vector<std::string>& found
) {
    std::vector<std::string> paths;
    for (const auto& port : link::list_candidate_ports()) {
        paths.push_back(port.path);
    }
    const auto hints = [](const std::string&) { return std::vector<std::uint32_t>(); };
    for (auto& lidar : co_await device::discover(executor, paths, hints, log)) {
        found.push_back(std::move(lidar.path));
    }
}

/// The lidars in these texts; a virtual one if there are none.
Result<std::vector<gateway::LidarUrl>, Problem>
to_urls(const std::vector<std::string>& texts, const std::shared_ptr<spdlog::logger>& log) {
    std::vector<gateway::LidarUrl> urls;
    for (const auto& text : texts) {
        auto url = gateway::parse_lidar_url(text);
        if (!url) {
            return url.error();
        }
        urls.push_back(std::move(*url));
    }
    if (urls.empty()) {
        log->warn(
            "no lidar found: starting a virtual one. Name a port with --lidar, e.g. --lidar "
            "/dev/ttyUSB0"
        );
        auto& stand_in = urls.emplace_back(*gateway::parse_lidar_url(default_virtual));
        stand_in.is_stand_in = true;
    }
    return urls;
}

Result<gateway::GatewayOptions, Problem> to_options(const ServeArguments& arguments) {
    gateway::GatewayOptions options;
    const auto http = net::parse_endpoint(arguments.http);
    if (!http) {
        return http.error();
    }
    options.http = *http;
    const auto tcp = net::parse_endpoint(arguments.tcp);
    if (!tcp) {
        return tcp.error();
    }
    options.tcp = *tcp;
    options.threads = arguments.threads;
    options.device.scan_at_once = !arguments.idle;
    options.device.mode = arguments.mode;
    options.memory_file = arguments.state_dir.empty()
                              ? gateway::default_memory_file()
                              : std::filesystem::path(arguments.state_dir) / "lidars.json";
    options.max_connections = most_connections(raise_descriptor_limit());
    return options;
}

void warn_if_open_to_others(const asio::ip::tcp::endpoint& http, spdlog::logger& log) {
    if (!http.address().is_loopback()) {
        log.warn(
            "listening on {}: anyone who reaches it can also stop the lidars; \"--http "
            "127.0.0.1:{}\" keeps it to this machine",
            net::to_text(http),
            http.port()
        );
    }
}

void print_addresses(const gateway::Gateway& gateway) {
    fmt::print(
        "page: http://{}/\ntcp: tcp://{}\n",
        net::to_text(net::callable(gateway.http_endpoint())),
        net::to_text(net::callable(gateway.tcp_endpoint()))
    );
    std::fflush(stdout);
}

int serve(const ServeArguments& arguments) {
    if (!log::set_level(arguments.log_level)) {
        return report(
            {{},
             fmt::format("no log level \"{}\"", arguments.log_level),
             "levels: debug, info, warning, error"}
        );
    }
    std::signal(SIGPIPE, SIG_IGN);  // a client that goes is an error of a write, not of the program
    google::protobuf::SetLogHandler(nullptr);  // it would let any client write to our log
    auto options = to_options(arguments);
    if (!options) {
        return report(options.error());
    }
    const auto log = log::make_logger("gateway");
    StopSignals signals;
    auto texts = arguments.lidars;
    if (texts.empty() && !signals.run(find_lidars(signals.executor(), log, texts))) {
        log->info("stopped before anything was started");
        return 0;
    }
    auto lidars = to_urls(texts, log);
    if (!lidars) {
        return report(lidars.error());
    }
    options->lidars = std::move(*lidars);
    auto gateway = gateway::Gateway::start(std::move(*options), log::make_logger);
    if (!gateway) {
        return report(gateway.error());
    }
    warn_if_open_to_others((*gateway)->http_endpoint(), *log);
    print_addresses(**gateway);
    signals.wait();
    log->info("stopping");
    (*gateway)->stop();
    log->info("stopped");
    return 0;
}

}  // namespace

void add_serve_command(CLI::App& app, int& exit_code) {
    auto arguments = std::make_shared<ServeArguments>();
    auto& command =
        *app.add_subcommand("serve", "Run the gateway: lidars in, page, stream and API out");
    command.add_option(
        "--lidar",
        arguments->lidars,
        "A lidar: a serial port, or virtual:MODEL[?world=FILE] for a virtual one. Repeatable. "
        "Without it every RPLIDAR found on a USB port is taken, and if there is none a virtual one "
        "is started"
    );
    command
        .add_option(
            "--http",
            arguments->http,
            "Where the page, the API and the WebSocket stream are (ADDRESS:PORT; port 0: any free "
            "one)"
        )
        ->capture_default_str();
    command.add_option("--tcp", arguments->tcp, "Where the TCP stream is (ADDRESS:PORT)")
        ->capture_default_str();
    command.add_option(
        "--mode",
        arguments->mode,
        "Scan mode, by name or id; without it the one that each lidar recommends"
    );
    command.add_flag("--idle", arguments->idle, "Do not start to scan until asked to");
    command.add_option("--threads", arguments->threads, "Threads for lidars and clients")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command.add_option(
        "--state-dir",
        arguments->state_dir,
        "Where the line speeds of lidars are remembered (default: $STATE_DIRECTORY, else "
        "~/.local/state/sweepcast)"
    );
    command.add_option("--log-level", arguments->log_level, "debug, info, warning or error")
        ->capture_default_str();
    command.footer(
        "Examples:\n"
        "  sweepcast serve                                    what is plugged in, or a virtual "
        "lidar\n"
        "  sweepcast serve --lidar /dev/ttyUSB0               one lidar\n"
        "  sweepcast serve --lidar virtual:a1m8 --http 0.0.0.0:8080\n"
        "                                                     a virtual one, open to the network"
    );
    command.callback([arguments, &exit_code] { exit_code = serve(*arguments); });
}

}  // namespace sweepcast::cli
