// `sweepcast serve`: the main job. Reads the options, finds the lidars, runs the gateway until told
// to stop.
#include "driver/virtual/error.hpp"
#include "server/cli/command.hpp"
#include "server/cli/descriptors.hpp"
#include "server/cli/lidar_choice.hpp"
#include "server/cli/print.hpp"
#include "server/cli/stop_signals.hpp"
#include "server/gateway/gateway.hpp"
#include "server/log/log.hpp"
#include "server/net/endpoint.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/system/errc.hpp>
#include <fmt/format.h>
#include <google/protobuf/stubs/logging.h>

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
    std::vector<std::string> host_names;
    std::vector<std::string> lidars;
    std::vector<std::string> discover;
    std::string mode;
    bool idle{};
    std::size_t threads{1};
    std::string state_dir;
    std::string log_level{"info"};
};

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
    options.host_names = arguments.host_names;
    options.threads = arguments.threads;
    options.device.scan_at_once = !arguments.idle;
    options.device.mode = arguments.mode;
    options.max_connections = most_connections(raise_descriptor_limit());
    return options;
}

/// Fills `memory` with what earlier runs learnt of the lidars here.
void remember(gateway::LidarMemory& memory, const std::string& state_dir, spdlog::logger& log) {
    const auto file = state_dir.empty() ? gateway::default_memory_file()
                                        : std::filesystem::path(state_dir) / "lidars.json";
    if (file.empty()) {
        return;
    }
    if (const auto opened = memory.open(file); !opened) {
        log.warn("{}: {}", opened.error().cause, opened.error().hint);
    }
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

/// Whether the gateway did not start because of a value on the command line.
bool is_misuse(const Problem& problem) {
    return problem.code == boost::system::errc::invalid_argument ||
           problem.code == virtual_lidar::errc::invalid_option;
}

void print_addresses(const gateway::Gateway& gateway) {
    print(
        stdout,
        "page: http://{}/\ntcp: tcp://{}\n",
        net::to_text(net::callable(gateway.http_endpoint())),
        net::to_text(net::callable(gateway.tcp_endpoint()))
    );
}

int serve(const ServeArguments& arguments) {
    if (!log::set_level(arguments.log_level)) {
        return report_misuse(
            {{},
             fmt::format("no log level \"{}\"", arguments.log_level),
             "levels: debug, info, warning, error"}
        );
    }
    ignore_write_signals();
    google::protobuf::SetLogHandler(nullptr);  // it would let any client write to our log
    auto options = to_options(arguments);
    if (!options) {
        return report_misuse(options.error());
    }
    const auto log = log::make_logger("gateway");
    StopSignals signals;
    remember(*options->memory, arguments.state_dir, *log);
    auto choice = choose_lidars(
        arguments.lidars,
        arguments.discover.empty() ? patterns_of_environment() : arguments.discover,
        log
    );
    if (!choice) {
        return report_misuse(choice.error());
    }
    if (choice->find &&
        !signals.run(find_lidars(signals.executor(), log, *options->memory, *choice))) {
        log->info("stopped before anything was started");
        return 0;
    }
    stand_in_for_none(*choice, *log);
    options->lidars = std::move(choice->lidars);
    options->patterns = std::move(choice->patterns);
    auto gateway = gateway::Gateway::start(std::move(*options), log::make_logger);
    if (!gateway) {
        return is_misuse(gateway.error()) ? report_misuse(gateway.error())
                                          : report(gateway.error());
    }
    warn_if_open_to_others((*gateway)->http_endpoint(), *log);
    print_addresses(**gateway);
    signals.wait();
    log->info("stopping");
    signals.finish([&gateway] { (*gateway)->stop(); });
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
        "A lidar: a serial port (/dev/ttyUSB0), tcp://HOST[:PORT], udp://HOST[:PORT], or "
        "virtual:MODEL[?world=FILE] for a virtual one, each with "
        "?name=ID&mode=NAME&hz=SPEED&motor_off_after=SECONDS (when nobody watches) if wanted; or "
        "another gateway's: sweepcast://HOST[:PORT][/ID][?name=ID]. Repeatable. Without "
        "it every RPLIDAR found on a USB port is taken, and if there "
        "is "
        "none a virtual one is started, until one is plugged in"
    );
    command.add_option(
        "--discover",
        arguments->discover,
        "Look for lidars on the ports of this pattern too, e.g. '/dev/ttyAMA*', and on USB ports "
        "even if --lidar is given. Repeatable; or the environment's SWEEPCAST_DISCOVER, with ':' "
        "between patterns"
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
        "--host-name",
        arguments->host_names,
        "Answer HTTP requests to this host name too (robot.example.com). IP addresses, localhost "
        "and the host name of this machine always work. Repeatable"
    );
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
        "Where lidars are remembered: serial numbers, ports, line speeds (default: "
        "$STATE_DIRECTORY, else ~/.local/state/sweepcast)"
    );
    command.add_option("--log-level", arguments->log_level, "debug, info, warning or error")
        ->capture_default_str();
    command.footer(
        "Examples:\n"
        "  sweepcast serve                                    what is plugged in, or a virtual "
        "lidar\n"
        "  sweepcast serve --lidar /dev/ttyUSB0               one lidar\n"
        "  sweepcast serve --discover '/dev/ttyAMA*'          what is plugged in, or on these "
        "ports\n"
        "  sweepcast serve --lidar 'udp://192.168.11.2?hz=10' a network lidar, at 10 turns a "
        "second\n"
        "  sweepcast serve --lidar '/dev/ttyUSB0?motor_off_after=60'\n"
        "                                                     whose motor rests while nobody "
        "watches\n"
        "  sweepcast serve --lidar virtual:a1m8 --http 0.0.0.0:8080\n"
        "                                                     a virtual one, open to the network\n"
        "  sweepcast serve --lidar sweepcast://robot:8081/A0E1C2D3\n"
        "                                                     another gateway's lidar, once over "
        "the "
        "network"
    );
    command.callback([arguments, &exit_code] { exit_code = serve(*arguments); });
}

}  // namespace sweepcast::cli
