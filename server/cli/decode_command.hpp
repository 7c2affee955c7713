// `sweepcast decode`: the samples in a capture or in raw measurement bytes.
#pragma once

namespace CLI {
class App;
}

namespace sweepcast::cli {

/// Adds the subcommand `decode` to `app`. When it is chosen it decodes to the end of its input and
/// sets `exit_code`: 0, or 1 if it could not read or write, or found no samples. `exit_code`
/// outlives the parsing.
void add_decode_command(CLI::App& app, int& exit_code);

}  // namespace sweepcast::cli
