// `sweepcast doctor`: says what is wrong with a lidar, if anything, and what to do about it.
#include "driver/diagnosis/diagnose.hpp"
#include "driver/diagnosis/port_findings.hpp"
#include "driver/link/discovery.hpp"
#include "server/api/diagnosis_message.hpp"
#include "server/api/json.hpp"
#include "server/cli/command.hpp"
#include "server/cli/doctor_output.hpp"
#include "server/cli/lidar_choice.hpp"
#include "server/cli/print.hpp"
#include "server/cli/stop_signals.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace sweepcast::cli {

namespace asio = boost::asio;
using device::Diagnosis;

namespace {

struct DoctorArguments {
    std::string url;
    std::vector<std::string> discover;
    bool json{};
};

/// Prints diagnoses as they come, and keeps the worst of them.
class Printer {
public:
    explicit Printer(bool json) : json_(json), text_(stdout, !json && wants_colour()) {}

    void begin(const std::string& port) {
        if (json_) {
            return;
        }
        write_text(stdout, std::exchange(first_, false) ? "" : "\n");
        text_.begin(port);
    }
    [[nodiscard]] diagnosis::OnCheck on_check() {
        return json_ ? diagnosis::OnCheck{}
                     : [this](const device::Check& check) { text_.check(check); };
    }
    void end(const Diagnosis& diagnosis) {
        failed_ = failed_ || diagnosis.verdict() == device::Verdict::failed;
        if (!json_) {
            text_.conclude(diagnosis);
            return;
        }
        v1::Diagnosis message;
        api::to_message(diagnosis, message);
        print_json_line(stdout, api::to_json_line(message));
    }
    [[nodiscard]] bool failed() const { return failed_; }

private:
    bool json_;
    bool first_{true};
    bool failed_{};
    DoctorText text_;
};

/// The ports that `serve` would look at. Those in use are examined too: that they are is a finding.
std::vector<link::LinkUrl> ports_to_examine(const std::vector<std::string>& patterns) {
    auto there = link::look_around(patterns, {});
    for (auto& port : there.usb) {
        port.holder.clear();
    }
    for (auto& matches : there.patterns) {
        for (auto& port : matches.ports) {
            port.holder.clear();
        }
    }
    const auto plan = link::plan_discovery(there);
    for (const auto& [path, why] : plan.skipped) {
        print(stderr, "not examining {}: {}\n", path, why);
    }
    std::vector<link::LinkUrl> urls;
    for (const auto& path : plan.look_at) {
        urls.push_back({path, link::SerialPlace{path, std::nullopt}});
    }
    return urls;
}

void report_no_port(Printer& printer) {
    const std::string where = "this machine's ports";
    printer.begin(where);
    diagnosis::DiagnosisBuilder builder(where, printer.on_check());
    builder.add(diagnosis::judge_no_port(link::list_usb_ports()));
    printer.end(builder.finish());
}

asio::awaitable<void>
examine_all(asio::any_io_executor executor, std::vector<link::LinkUrl> urls, Printer& printer) {
    for (auto& url : urls) {
        printer.begin(url.text);
        // Named first: g++ 12 destroys such temporaries of a co_await twice.
        auto on_check = printer.on_check();
        const auto diagnosis =
            co_await diagnosis::diagnose(executor, std::move(url), {}, std::move(on_check));
        printer.end(diagnosis);
    }
}

int doctor(const DoctorArguments& arguments) {
    std::vector<link::LinkUrl> urls;
    if (arguments.url.empty()) {
        urls = ports_to_examine(
            arguments.discover.empty() ? patterns_of_environment() : arguments.discover
        );
    } else {
        auto url = link::parse_link_url(arguments.url);
        if (!url) {
            return report_misuse(url.error());
        }
        urls.push_back(std::move(*url));
    }
    ignore_write_signals();
    Printer printer(arguments.json);
    if (urls.empty()) {
        report_no_port(printer);
        return 1;
    }
    StopSignals signals;
    if (!signals.run(examine_all(signals.executor(), std::move(urls), printer))) {
        print(stderr, "stopped: no scan goes on, the motor is off\n");
        return exit_stopped;
    }
    return printer.failed() ? 1 : 0;
}

}  // namespace

void add_doctor_command(CLI::App& app, int& exit_code) {
    auto arguments = std::make_shared<DoctorArguments>();
    auto& command = *app.add_subcommand(
        "doctor",
        "Say what is wrong with a lidar, if anything, and what to do about it"
    );
    auto* url = command.add_option(
        "url",
        arguments->url,
        "A serial port (its line speed is found out, or ?baud=N), tcp://HOST or udp://HOST; "
        "without it, every port on which `serve` would look for lidars"
    );
    command
        .add_option(
            "--discover",
            arguments->discover,
            "Examine the ports of this pattern too, e.g. '/dev/ttyAMA*'. Repeatable; or the "
            "environment's SWEEPCAST_DISCOVER, with ':' between patterns"
        )
        ->allow_extra_args(false)
        ->excludes(url);
    command.add_flag("--json", arguments->json, "Print a line of JSON a port");
    command.footer(
        "Checks a chain: is the port there, may it be opened, does anyone else use it, is anything "
        "heard, at\n"
        "which line speed, does a lidar answer, is it healthy, does its motor turn, do whole "
        "revolutions come,\n"
        "is the line clean, is the speed right. Stops at the first thing that is wrong and says "
        "why, most\n"
        "likely, and what to do. The lidar is made to scan for some seconds; a port that another "
        "program has\n"
        "open is left alone. Exit code: 0 if the lidar works, 1 if it does not, 130 after "
        "Ctrl-C.\n\n"
        "Examples:\n"
        "  sweepcast doctor\n"
        "  sweepcast doctor /dev/ttyUSB0\n"
        "  sweepcast doctor '/dev/ttyUSB0?baud=256000'\n"
        "  sweepcast doctor udp://192.168.11.2\n"
        "  sweepcast doctor --json /dev/ttyUSB0 | jq -r .cause"
    );
    command.callback([arguments, &exit_code] { exit_code = doctor(*arguments); });
}

}  // namespace sweepcast::cli
