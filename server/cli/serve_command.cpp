// `sweepcast serve`: the main job. Reads the options, finds the lidars, runs the gateway until told
// to stop.
#include "driver/device/probe.hpp"
#include "server/cli/command.hpp"
#include "server/gateway/gateway.hpp"
#include "server/log/log.hpp"
#include "server/net/endpoint.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/use_future.hpp>
#include <fmt/format.h>
#include <google/protobuf/stubs/logging.h>

#include <csignal>
#include <cstdio>
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
    std::string log_level{"info"};
};

constexpr const char* default_virtual = "virtual:a1m8";

/// The ports where a lidar answers.
std::vector<std::string> find_lidars(const std::shared_ptr<spdlog::logger>& log) {
    asio::io_context context;
    auto found =
        asio::co_spawn(context, device::discover(context.get_executor(), log), asio::use_future);
    context.run();
    return found.get();
}

/// The lidars the user named; else those that are found; else a virtual one.
Result<std::vector<gateway::LidarUrl>, Problem>
choose_lidars(const std::vector<std::string>& named, const std::shared_ptr<spdlog::logger>& log) {
    const auto texts = named.empty() ? find_lidars(log) : named;
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
    auto lidars = choose_lidars(arguments.lidars, log::make_logger("gateway"));
    if (!lidars) {
        return lidars.error();
    }
    options.lidars = std::move(*lidars);
    return options;
}

/// SIGINT and SIGTERM, held back from the moment it exists so that none falls between starting and
/// waiting.
class StopSignals {
public:
    StopSignals() {
        signals_.async_wait([](const boost::system::error_code&, int) {});
    }
    void wait() { context_.run(); }

private:
    asio::io_context context_;
    asio::signal_set signals_{context_, SIGINT, SIGTERM};
};

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
    auto signals = std::make_unique<StopSignals>();
    auto gateway = gateway::Gateway::start(std::move(*options), log::make_logger);
    if (!gateway) {
        return report(gateway.error());
    }
    fmt::print(
        "page: http://{}/\ntcp: tcp://{}\n",
        net::to_text((*gateway)->http_endpoint()),
        net::to_text((*gateway)->tcp_endpoint())
    );
    std::fflush(stdout);
    signals->wait();
    signals.reset();  // a second signal finds the default action again and ends the program at once
    const auto log = log::make_logger("gateway");
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
        "Scan mode, by name; without it each lidar's fastest"
    );
    command.add_flag("--idle", arguments->idle, "Do not start to scan until asked to");
    command.add_option("--threads", arguments->threads, "Threads for lidars and clients")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
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
