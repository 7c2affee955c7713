// The options by which a user says what to get of a stream.
#pragma once

#include "sweepcast/v1/stream.pb.h"

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace sweepcast::cli {

/// Adds them to `command`; what is given goes into `wish`, which must live as long as the command.
/// Each is in the group "What to get".
void add_wish_options(CLI::App& command, v1::Subscribe& wish);

/// The first one of these options that was given on the command line; none: none was.
[[nodiscard]] std::optional<std::string> given_wish_option(const CLI::App& command);

/// Reads "FROM-TO" in degrees, such as "90-270" or, over 0, "350-10.5"; none if it is no such
/// thing.
[[nodiscard]] std::optional<v1::AngleWindow> parse_angle_window(const std::string& text);

}  // namespace sweepcast::cli
