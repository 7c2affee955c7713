// `sweepcast capture`: the raw bytes of a lidar into a file, to be looked at or played elsewhere.
#pragma once

namespace CLI {
class App;
}

namespace sweepcast::cli {

/// Adds the subcommand `capture` to `app`. When it is chosen it captures until SIGINT or SIGTERM or
/// for as long as it is told and then sets `exit_code`: 0, or 1 if it could not, or not all of it.
/// `exit_code` outlives the parsing.
void add_capture_command(CLI::App& app, int& exit_code);

}  // namespace sweepcast::cli
