#include "server/cli/virtual_command.hpp"

#include "driver/async/task_group.hpp"
#include "driver/virtual/control_socket.hpp"
#include "driver/virtual/error.hpp"
#include "driver/virtual/fault_command.hpp"
#include "driver/virtual/faults.hpp"
#include "driver/virtual/persona.hpp"
#include "driver/virtual/virtual_lidar.hpp"
#include "server/cli/command.hpp"
#include "server/cli/print.hpp"
#include "server/cli/stop_signals.hpp"
#include "server/log/log.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sweepcast::cli {

namespace asio = boost::asio;
using virtual_lidar::VirtualLidar;
using virtual_lidar::VirtualLidarOptions;

namespace {

constexpr const char* description = "Play a lidar, for those who have none";

constexpr const char* footer_before_faults = R"(
The first line on standard output is what to open: the path of a pseudo terminal such as /dev/pts/5, or
with --listen a URL. Open it as you would open a real scanner. A pseudo terminal has a speed: whoever
sets another than the scanner's gets garbage, as from a real one (--list-models shows the speeds).
Whoever sets none gets the right one. The log goes to standard error. Ctrl-C ends it.

Motors behave as the model's: that of an A1 runs from the start and does not regulate its speed; A2 and
A3 turn by SET_MOTOR_PWM (0xF0), each exemplar a little off; S and T by rpm (0xA8); a C1 spins by itself
while it scans. In place of the modem line DTR of an A1, which is not to be had here, SET_MOTOR_PWM
switches the motor: 0 is off, anything else is on. A real A1 ignores that request.

A world is a CSV file with the header "angle_deg,distance_mm" and a point a line; angles are clockwise
seen from above, from 0 up to 360. Without one you get a living room in which someone walks.

A recording holds the raw bytes of the measurement packets that were sent, without the descriptors.
A truth file holds a line for each packet that was measured: the number of its scan, its answer type
and its bytes in hex, as they were before anything damaged them.

Faults (--fault, as often as you like):
)";

constexpr const char* footer_before_commands = R"(
Commands, for a lidar that runs (--schedule, or --control and --send):
)";

constexpr const char* footer_after_commands =
    R"(  status                   tells what is on (not in a schedule)

A schedule is a list of times from the start (ms, s, m) and commands, with commas between them. A control
socket takes a command a line and answers each with a line: "ok", or "error: " and why. Signal USR1
unplugs the lidar, and plugs it in at the next one.
)";

constexpr const char* examples = R"(
Examples:
  sweepcast virtual
  sweepcast virtual --list-models
  sweepcast virtual --model a3m1 --link /tmp/lidar --noise 5 --dropout 0.02
  sweepcast virtual --world room.csv --noise 0 --seed 7
  sweepcast virtual --model t1 --listen udp://127.0.0.1:8089
  sweepcast virtual --model s1 --listen tcp://127.0.0.1:20108
  sweepcast virtual --play bug.capture --loop
  sweepcast virtual --model s2 --fault noise=0.001 --fault warning=0x8001
  sweepcast virtual --link /tmp/lidar --schedule '3s unplug, 5s replug, 8s fault noise=0.02, 12s clear'
  sweepcast virtual --link /tmp/lidar --control /tmp/lidar.control
  sweepcast virtual --control /tmp/lidar.control --send unplug
  sweepcast virtual --control /tmp/lidar.control --send 'replug /tmp/other' --send status)";

std::string_view motor_of(const virtual_lidar::Persona& persona) {
    switch (persona.motor.control) {
    case protocol::MotorControl::modem_line:
        return "DTR, on or off";
    case protocol::MotorControl::accessory_board:
        return "PWM";
    case protocol::MotorControl::rpm:
        return "rpm";
    case protocol::MotorControl::self:
        return "spins by itself";
    }
    return "";
}

std::string speed_of(const virtual_lidar::Persona& persona) {
    return persona.connection == virtual_lidar::Connection::ethernet ? "UDP"
                                                                     : std::to_string(persona.baud);
}

// Text written in a fixed width, a line for each scan mode.
std::string table_of_models() {
    std::string table = fmt::format(
        "{:<9}  {:<28}  {:>7}  {:<16}  {}\n",
        "model",
        "name",
        "baud",
        "motor",
        "scan modes (* typical): id, name, samples per second, range, answer type"
    );
    for (const auto& persona : virtual_lidar::personas()) {
        auto key = persona.key;
        for (std::size_t id = 0; id < persona.modes.size(); ++id) {
            const auto& mode = persona.modes[id];
            const std::chrono::duration<double> sample = mode.sample_duration();
            table += fmt::format(
                "{:<9}  {:<28}  {:>7}  {:<16}  {}{} {:<12} {:>6.0f}/s  {:>2} m  0x{:02X}\n",
                key,
                id == 0 ? persona.title : "",
                id == 0 ? speed_of(persona) : "",
                id == 0 ? motor_of(persona) : "",
                id == persona.typical_mode ? '*' : ' ',
                id,
                mode.name,
                1.0 / sample.count(),
                mode.max_distance_q8_m / 256U,
                static_cast<unsigned>(mode.answer)
            );
            key = "";
        }
    }
    return table;
}

// Runs the lidar to its end, and lets nothing else keep the process alive after it.
asio::awaitable<void>
play(VirtualLidar& lidar, asio::signal_set& signals, asio::signal_set& plug_signals) {
    co_await lidar.run();
    signals.cancel();
    plug_signals.cancel();
}

// At each signal it is unplugged, or plugged in again.
void plug_at_signals(VirtualLidar& lidar, asio::signal_set& signals) {
    signals.async_wait([&lidar, &signals](const boost::system::error_code& cancelled, int) {
        if (cancelled) {
            return;
        }
        const auto obeyed = lidar.is_plugged() ? lidar.obey(virtual_lidar::Unplug{})
                                               : lidar.obey(virtual_lidar::Replug{});
        if (!obeyed) {
            report(obeyed.error());
        }
        plug_at_signals(lidar, signals);
    });
}

// Tells a virtual lidar that runs what to do, and prints what it answers. Ends at the first command
// that it does not obey.
int send(const std::string& control, const std::vector<std::string>& commands) {
    if (control.empty()) {
        return report_misuse(
            {make_error_code(virtual_lidar::errc::invalid_option),
             "which virtual lidar is the command for?",
             "give the path of its control socket: --control PATH"}
        );
    }
    for (const auto& command : commands) {
        if (command.find_first_of("\r\n") != std::string::npos) {
            return report_misuse(
                {make_error_code(virtual_lidar::errc::invalid_option),
                 "a command is one line",
                 "give more of them with --send each"}
            );
        }
        const auto answer = virtual_lidar::ask_control_socket(control, command);
        if (!answer) {
            return report(answer.error());
        }
        constexpr std::string_view error = "error: ";
        if (!answer->starts_with("ok")) {
            const bool marked = answer->starts_with(error);
            print(stderr, "sweepcast: {}\n", answer->substr(marked ? error.size() : 0));
            return exit_failed;
        }
        print(stdout, "{}\n", *answer);
    }
    return 0;
}

int run(const VirtualLidarOptions& options) {
    ignore_write_signals();
    asio::io_context context(1);
    // Before the port is there: a signal that comes early must not leave a link behind.
    asio::signal_set signals(context);
    add_stop_signals(signals, SIGUSR1);
    asio::signal_set plug_signals(context, SIGUSR1);
    auto lidar = VirtualLidar::create(context.get_executor(), options, log::make_logger("virtual"));
    if (!lidar) {
        const bool misused = lidar.error().code == virtual_lidar::errc::invalid_option;
        return misused ? report_misuse(lidar.error()) : report(lidar.error());
    }
    print(stdout, "{}\n", (*lidar)->port());  // at once: a script may wait for it

    std::exception_ptr failure;
    async::TaskGroup tasks(context.get_executor(), [&](std::exception_ptr thrown) {
        failure = std::move(thrown);
        signals.cancel();
        plug_signals.cancel();
    });
    signals.async_wait([&lidar](const boost::system::error_code& cancelled, int) {
        if (!cancelled) {
            (*lidar)->stop();
        }
    });
    plug_at_signals(**lidar, plug_signals);
    tasks.spawn(play(**lidar, signals, plug_signals));
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
    const auto list_models = std::make_shared<bool>(false);
    const auto commands = std::make_shared<std::vector<std::string>>();
    command->footer(
        footer_before_faults + virtual_lidar::faults_help() + footer_before_commands +
        virtual_lidar::fault_commands_help() + footer_after_commands + examples
    );
    command->add_option("--model", options->model, "Which scanner to play; \"list\" lists them")
        ->capture_default_str();
    command->add_flag("--list-models", *list_models, "List the scanners with their modes, and end");
    command->add_option(
        "--listen",
        options->listen,
        "Play it on the network: tcp://ADDRESS:PORT, udp://ADDRESS:PORT, or ADDRESS:PORT for what\n"
        "the model has"
    );
    command->add_option("--link", options->link, "Make a symbolic link to the port at this path");
    command->add_flag("--any-baud", options->any_baud, "Understand hosts that set another speed");
    command->add_option("--fault", options->faults, "Something that is wrong with it; see below")
        ->allow_extra_args(false);
    command
        ->add_option(
            "--schedule",
            options->schedule,
            "Commands at times from the start: '3s unplug, 5s replug'; see below"
        )
        ->allow_extra_args(false);
    command->add_option(
        "--control",
        options->control,
        "Make a Unix socket at this path that takes commands; see below"
    );
    command
        ->add_option(
            "--send",
            *commands,
            "Send this command to the virtual lidar whose --control is given, and end"
        )
        ->allow_extra_args(false);
    command->add_option("--world", options->world, "What it sees: a CSV file of points");
    command->add_option(
        "--noise",
        options->noise_mm,
        "Standard deviation of distances in mm (default: as the model's)"
    );
    command->add_option("--dropout", options->dropout, "Part of measurements without an echo, 0..1")
        ->capture_default_str();
    command->add_option("--seed", options->seed, "Of noise, dropouts and faults")
        ->capture_default_str();
    command->add_option(
        "--serial",
        options->serial,
        "Serial number, 32 hex digits (default: from model, link and seed)"
    );
    command->add_option(
        "--play",
        options->play,
        "Play this capture, as the scanner that it is of, when a scan is started"
    );
    command->add_flag("--loop", options->loop, "Play the capture again and again");
    command->add_option("--record", options->recording, "File for the measurement bytes sent");
    command->add_option(
        "--truth",
        options->truth,
        "File for the packets as they were measured, before any fault"
    );
    command->callback([options, list_models, commands, &exit_code] {
        if (*list_models || options->model == "list") {
            write_text(stdout, table_of_models());
            exit_code = 0;
        } else if (!commands->empty()) {
            exit_code = send(options->control, *commands);
        } else {
            exit_code = run(*options);
        }
    });
}

}  // namespace sweepcast::cli
