// The one binary: its subcommands, and the last resort for what they throw.
#include "server/cli/capture_command.hpp"
#include "server/cli/command.hpp"
#include "server/cli/decode_command.hpp"
#include "server/cli/virtual_command.hpp"
#include "server/version.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <string>

namespace {

int run(int argc, char** argv) {
    CLI::App app{"Sweepcast: a gateway for RPLIDAR laser scanners"};
    app.set_version_flag("--version", std::string("sweepcast ") + sweepcast::version);
    app.require_subcommand(1);
    app.footer(
        "`sweepcast COMMAND --help` explains a command. The page is at http://127.0.0.1:8080/ "
        "while `serve` runs."
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
        return app.exit(wrong);
    }
    return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& failure) {
        fmt::print(stderr, "sweepcast: {}\n", failure.what());
        return 1;
    }
}
