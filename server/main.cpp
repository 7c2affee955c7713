// The one binary: its subcommands, and the last resort for what they throw.
#include "driver/protocol/result.hpp"
#include "server/cli/capture_command.hpp"
#include "server/cli/command.hpp"
#include "server/cli/decode_command.hpp"
#include "server/cli/virtual_command.hpp"
#include "server/version.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <string>
#include <vector>

namespace {

using sweepcast::Problem;

std::vector<std::string> command_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
    }
    return names;
}

/// Explains a command line that CLI11 could not parse.
Problem explain(const CLI::App& app, const CLI::ParseError& wrong) {
    const auto chosen = app.get_subcommands();
    if (!chosen.empty()) {
        const auto& command = chosen.front()->get_name();
        return {
            {},
            wrong.what(),
            fmt::format("`sweepcast {} --help` explains the command", command)};
    }
    const auto hint = fmt::format("the commands are {}", fmt::join(command_names(app), ", "));
    const auto unknown = app.remaining();
    const auto named = std::ranges::find_if(unknown, [](const std::string& argument) {
        return !argument.starts_with('-');
    });
    if (named != unknown.end()) {
        return {{}, fmt::format("there is no command \"{}\"", *named), hint};
    }
    if (!unknown.empty()) {
        return {
            {},
            fmt::format("there is no option \"{}\" before a command", unknown.front()),
            "give a command first; " + hint};
    }
    return {{}, "a command is missing", hint};
}

int run(int argc, char** argv) {
    CLI::App app{"Sweepcast: a gateway for RPLIDAR laser scanners"};
    app.set_version_flag("--version", std::string("sweepcast ") + sweepcast::version);
    app.require_subcommand(1);
    app.footer(
        "`sweepcast COMMAND --help` explains a command. The page is at http://127.0.0.1:8080/ "
        "while `serve` runs.\n"
        "\n"
        "Exit codes:\n"
        "  0    done, or ended by a signal as wanted (Ctrl-C, SIGTERM, SIGHUP, ...)\n"
        "  1    it did not work: standard error says why. `doctor`: the lidar does not work\n"
        "  2    the command line is wrong\n"
        "  130  `doctor` was ended by a signal before its verdict"
    );
    int exit_code = 0;
    sweepcast::cli::add_serve_command(app, exit_code);
    sweepcast::cli::add_watch_command(app, exit_code);
    sweepcast::cli::add_virtual_command(app, exit_code);
    sweepcast::cli::add_probe_command(app, exit_code);
    sweepcast::cli::add_doctor_command(app, exit_code);
    sweepcast::cli::add_address_command(app, exit_code);
    sweepcast::cli::add_capture_command(app, exit_code);
    sweepcast::cli::add_decode_command(app, exit_code);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& wrong) {
        constexpr int asked_for_help = 0;
        return wrong.get_exit_code() == asked_for_help
                   ? app.exit(wrong)
                   : sweepcast::cli::report_misuse(explain(app, wrong));
    }
    return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& failure) {
        return sweepcast::cli::report({{}, failure.what(), ""});
    }
}
