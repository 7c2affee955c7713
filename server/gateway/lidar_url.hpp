// Where a lidar is, as users write it.
#pragma once

#include "driver/protocol/result.hpp"

#include <string>
#include <string_view>
#include <variant>

namespace sweepcast::gateway {

/// A scanner on a serial port.
struct SerialLidar {
    std::string path;
};

/// A virtual lidar that the gateway starts itself, on a pseudo terminal of its own.
struct VirtualLidarUrl {
    std::string model;
    std::string world;  ///< file; empty: the built-in room
};

struct LidarUrl {
    std::string text;  ///< as the user wrote it
    std::variant<SerialLidar, VirtualLidarUrl> where;
    /// Nobody asked for it: it stands in for a lidar that was not found.
    bool is_stand_in{};
};

/// Reads "/dev/ttyUSB0" (any path) or "virtual:a1m8", "virtual:a1m8?world=FILE".
[[nodiscard]] Result<LidarUrl, Problem> parse_lidar_url(std::string_view text);

/// The name a lidar goes by until it has been identified: the last part of its port's path, or
/// "virtual-a1m8".
[[nodiscard]] std::string port_name(const LidarUrl& url);

}  // namespace sweepcast::gateway
