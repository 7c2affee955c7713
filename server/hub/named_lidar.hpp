// find_named: decides which lidar a user means by a name. The gateway that owns the lidars and one
// that publishes them again share this rule.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sweepcast::hub {

/// The names of one lidar. A name that is not known is empty.
struct LidarNames {
    std::string id{};
    std::string serial_number{};  ///< all digits
    std::string port_name{};
};

/// The result of a search by name.
struct NamedLidar {
    std::optional<std::size_t> index{};  ///< of the lidar that is meant
    bool is_ambiguous{};                 ///< the name fits several lidars equally well
};

/// Returns the lidar that `name` means. An id goes before a whole serial number, that before the
/// first eight digits of one, and these before a port name. A name that fits two lidars equally
/// well means neither.
[[nodiscard]] NamedLidar find_named(std::span<const LidarNames> lidars, std::string_view name);

}  // namespace sweepcast::hub
