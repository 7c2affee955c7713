// What every subcommand of the program shares.
#pragma once

#include "driver/protocol/result.hpp"

namespace CLI {
class App;
}

namespace sweepcast::cli {

/// Prints "sweepcast: <cause>" and the hint to standard error, and returns the exit code for it.
int report(const Problem& problem);

/// Each adds its subcommand to `app`; if it is the chosen one, it runs while the command line is
/// parsed and leaves its exit code in `exit_code`.
void add_serve_command(CLI::App& app, int& exit_code);
void add_watch_command(CLI::App& app, int& exit_code);
void add_probe_command(CLI::App& app, int& exit_code);
void add_doctor_command(CLI::App& app, int& exit_code);
void add_address_command(CLI::App& app, int& exit_code);

}  // namespace sweepcast::cli
