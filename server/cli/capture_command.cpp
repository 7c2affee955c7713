#include "server/cli/capture_command.hpp"

#include "server/cli/capture_session.hpp"
#include "server/cli/command.hpp"
#include "server/cli/lidar_choice.hpp"
#include "server/cli/stop_signals.hpp"
#include "server/gateway/lidar_memory.hpp"
#include "server/gateway/lidar_url.hpp"
#include "server/log/log.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/system/errc.hpp>
#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace sweepcast::cli {

namespace asio = boost::asio;

namespace {

constexpr const char* capture_footer = R"(
The lidar is asked who it is, then scans, and every byte in both directions goes into the file with the time at
which it passed. Such a file shows what a lidar really said: attach it to a bug report (`zstd` makes it smaller).

Examples:
  sweepcast capture                                         the one lidar there is, until Ctrl-C
  sweepcast capture /dev/ttyUSB0 --seconds 10 -o bug.sweepcast
  sweepcast capture udp://192.168.11.2 --mode Standard --speed 7
  sweepcast capture /dev/ttyUSB0 --seconds 60 -o - | zstd > bug.sweepcast.zst

What to do with it:
  sweepcast decode bug.sweepcast > samples.csv
  sweepcast virtual --play bug.sweepcast --loop)";

struct CaptureArguments {
    std::string url;
    std::optional<std::uint32_t> baud;
    std::string output;
    std::optional<double> seconds;
    std::string mode;
    double speed_hz{};
    bool force{};
};

Problem no_single_lidar(const std::vector<gateway::LidarUrl>& found) {
    if (found.empty()) {
        return {
            make_error_code(boost::system::errc::no_such_device),
            "no lidar was found",
            "name its port or address, such as: sweepcast capture /dev/ttyUSB0"};
    }
    std::string names;
    for (const auto& lidar : found) {
        names += (names.empty() ? "" : ", ") + lidar.text;
    }
    return {
        make_error_code(boost::system::errc::invalid_argument),
        fmt::format("there are {} lidars: {}", found.size(), names),
        "name the one to capture, such as: sweepcast capture " + found.front().text};
}

/// Has `options` tell of the only lidar that answers on this machine.
asio::awaitable<void> find_lidar(
    asio::any_io_executor executor,
    CaptureOptions& options,
    std::optional<Problem>& problem
) {
    LidarChoice choice;
    choice.patterns = patterns_of_environment();
    const auto log = log::make_logger("capture");
    const gateway::LidarMemory no_memory;
    co_await find_lidars(executor, log, no_memory, choice);
    if (choice.lidars.size() != 1) {
        problem = no_single_lidar(choice.lidars);
        co_return;
    }
    const auto& found = choice.lidars.front();
    options.url = std::get<link::LinkUrl>(found.where);
    if (found.baud_hint) {
        options.baud_hints = {*found.baud_hint};
    }
}

/// What is told by URL and --baud.
Result<link::LinkUrl, Problem> to_url(const CaptureArguments& arguments) {
    auto url = link::parse_link_url(arguments.url);
    if (!url || !arguments.baud) {
        return url;
    }
    auto* port = std::get_if<link::SerialPlace>(&url->where);
    if (port == nullptr) {
        return Problem{
            make_error_code(boost::system::errc::invalid_argument),
            arguments.url + " has no line speed",
            "--baud is for serial ports"};
    }
    port->baud = arguments.baud;
    return url;
}

Result<CaptureOptions, Problem> to_options(const CaptureArguments& arguments) {
    CaptureOptions options;
    if (!arguments.url.empty()) {
        auto url = to_url(arguments);
        if (!url) {
            return url.error();
        }
        options.url = std::move(*url);
    }
    options.mode = arguments.mode;
    options.speed_hz = arguments.speed_hz;
    if (arguments.seconds) {
        options.length = std::chrono::duration_cast<std::chrono::nanoseconds>(
            std::chrono::duration<double>(*arguments.seconds)
        );
    }
    options.path = arguments.output;
    options.existing = arguments.force ? Existing::replace : Existing::refuse;
    return options;
}

asio::awaitable<void> run(CaptureSession& session, std::optional<Problem>& problem) {
    const auto ended = co_await session.run();
    if (!ended) {
        problem = ended.error();
    }
}

int capture(const CaptureArguments& arguments) {
    auto options = to_options(arguments);
    if (!options) {
        return report_misuse(options.error());
    }
    if (!options->path.empty()) {
        if (auto writable = check_output(options->path, options->existing); !writable) {
            return report(writable.error());
        }
    }
    ignore_write_signals();
    StopSignals signals;
    std::optional<Problem> problem;
    if (arguments.url.empty()) {
        if (!signals.run(find_lidar(signals.executor(), *options, problem))) {
            return 1;
        }
        if (problem) {
            return report(*problem);
        }
        if (arguments.baud) {
            options->baud_hints = {*arguments.baud};
        }
    }
    CaptureSession session(signals.executor(), std::move(*options));
    signals.run(run(session, problem), [&session] { session.stop(); });
    return problem ? report(*problem) : 0;
}

}  // namespace

void add_capture_command(CLI::App& app, int& exit_code) {
    constexpr double longest_seconds = 31'536'000;  // a year, as long as a capture may be
    auto arguments = std::make_shared<CaptureArguments>();
    auto& command = *app.add_subcommand(
        "capture",
        "Write the raw bytes of a lidar to a file, with times (a running scan is ended)"
    );
    command.add_option(
        "url",
        arguments->url,
        "A serial port (its line speed is found out, or --baud N), tcp://HOST or udp://HOST; "
        "without "
        "it the one lidar that is found on this machine"
    );
    command.add_option(
        "-o,--output",
        arguments->output,
        "File to write, - is standard output (default: MODEL-SERIAL-TIME.sweepcast)"
    );
    command.add_flag("--force", arguments->force, "Write a file anew that exists already");
    command.add_option("--seconds", arguments->seconds, "End so long after the first samples")
        ->check(CLI::Range(0.001, longest_seconds));
    command
        .add_option("--mode", arguments->mode, "Scan mode, by name or id (default: the typical)");
    command
        .add_option("--speed", arguments->speed_hz, "Turns a second; 0: the lidar's usual speed")
        ->capture_default_str();
    command.add_option("--baud", arguments->baud, "Line speed, in place of trying the usual ones")
        ->check(CLI::Range(link::lowest_baud, link::highest_baud));
    command.footer(capture_footer);
    command.callback([arguments, &exit_code] { exit_code = capture(*arguments); });
}

}  // namespace sweepcast::cli
