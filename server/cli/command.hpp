// What every subcommand of the program shares.
#pragma once

#include "driver/protocol/result.hpp"

namespace CLI {
class App;
}

namespace sweepcast::cli {

/// Exit codes of all commands, as `sweepcast --help` tells them.
constexpr int exit_failed = 1;     ///< the command could not do what it was asked to
constexpr int exit_misused = 2;    ///< the command line is wrong
constexpr int exit_stopped = 130;  ///< `doctor` was stopped before its verdict

/// Prints "sweepcast: <cause>" and the hint to standard error, and returns exit_failed.
int report(const Problem& problem);

/// Prints likewise what is wrong with the command line, and returns exit_misused.
int report_misuse(const Problem& problem);

/// Each adds its subcommand to `app`; if it is the chosen one, it runs while the command line is
/// parsed and leaves its exit code in `exit_code`.
void add_serve_command(CLI::App& app, int& exit_code);
void add_watch_command(CLI::App& app, int& exit_code);
void add_probe_command(CLI::App& app, int& exit_code);
void add_doctor_command(CLI::App& app, int& exit_code);
void add_address_command(CLI::App& app, int& exit_code);

}  // namespace sweepcast::cli
