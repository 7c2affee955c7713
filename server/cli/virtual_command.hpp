// `sweepcast virtual`: a lidar for those who have none at hand.
#pragma once

namespace CLI {
class App;
}

namespace sweepcast::cli {

/// Adds the subcommand `virtual` to `app`. When it is chosen it plays a lidar until SIGINT or
/// SIGTERM and then sets `exit_code`: 0, or 1 if it could not. `exit_code` outlives the parsing.
void add_virtual_command(CLI::App& app, int& exit_code);

}  // namespace sweepcast::cli
