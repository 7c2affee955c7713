#include "server/cli/virtual_command.hpp"

#include "driver/async/task_group.hpp"
#include "driver/virtual/virtual_lidar.hpp"
#include "server/cli/command.hpp"
#include "server/log/log.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <fmt/core.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <utility>

namespace sweepcast::cli {

namespace asio = boost::asio;
using virtual_lidar::VirtualLidar;
using virtual_lidar::VirtualLidarOptions;

namespace {

constexpr const char* description = "Play a lidar on a pseudo terminal, for those who have none";

constexpr const char* footer = R"(
The first line on standard output is the path of the port, e.g. /dev/pts/5. Open it as you would open
the serial port of a real scanner; any baud rate will do, data comes at the scanner's own. The log goes
to standard error. Ctrl-C ends it.

The motor runs from the start, as that of a real A1 does. A pseudo terminal has no modem lines, so
instead of DTR the request SET_MOTOR_PWM (0xF0) switches it: 0 is off, anything else is on. A real A1
ignores that request.

A world is a CSV file with the header "angle_deg,distance_mm" and a point a line; angles are clockwise
seen from above, from 0 up to 360. Without one you get a living room in which someone walks.

A recording holds the raw bytes of the measurement packets that were sent, without the descriptors.

Examples:
  sweepcast virtual
  sweepcast virtual --link /tmp/lidar --noise 5 --dropout 0.02
  sweepcast virtual --world room.csv --noise 0 --seed 7)";

// Runs the lidar to its end, and lets nothing else keep the process alive after it.
asio::awaitable<void> play(VirtualLidar& lidar, asio::signal_set& signals) {
    co_await lidar.run();
    signals.cancel();
}

int run(const VirtualLidarOptions& options) {
    asio::io_context context(1);
    // Before the port is there: a signal that comes early must not leave a link behind.
    asio::signal_set signals(context, SIGINT, SIGTERM);
    auto lidar = VirtualLidar::create(context.get_executor(), options, log::make_logger("virtual"));
    if (!lidar) {
        return report(lidar.error());
    }
    fmt::print("{}\n", (*lidar)->port());
    std::fflush(stdout);  // whoever reads it from a pipe waits for it

    std::exception_ptr failure;
    async::TaskGroup tasks(context.get_executor(), [&](std::exception_ptr thrown) {
        failure = std::move(thrown);
        signals.cancel();
    });
    signals.async_wait([&lidar](const boost::system::error_code& cancelled, int) {
        if (!cancelled) {
            (*lidar)->stop();
        }
    });
    tasks.spawn(play(**lidar, signals));
    context.run();
    if (failure) {
        std::rethrow_exception(failure);
    }
    return 0;
}

}  // namespace

void add_virtual_command(CLI::App& app, int& exit_code) {
    auto* const command = app.add_subcommand("virtual", description);
    const auto options = std::make_shared<VirtualLidarOptions>();
    command->footer(footer);
    command->add_option("--model", options->model, "Which scanner to play; a1m8 is the only one")
        ->capture_default_str();
    command->add_option("--link", options->link, "Make a symbolic link to the port at this path");
    command->add_option("--world", options->world, "What it sees: a CSV file of points");
    command->add_option(
        "--noise",
        options->noise_mm,
        "Standard deviation of distances in mm (default: as the model's)"
    );
    command->add_option("--dropout", options->dropout, "Part of measurements without an echo, 0..1")
        ->capture_default_str();
    command->add_option("--seed", options->seed, "Of noise and dropouts")->capture_default_str();
    command->add_option(
        "--serial",
        options->serial,
        "Serial number, 32 hex digits (default: from model, link and seed)"
    );
    command->add_option("--record", options->recording, "File for the measurement bytes sent");
    command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace sweepcast::cli
