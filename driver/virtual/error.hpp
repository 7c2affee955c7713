// What can go wrong with a virtual lidar, as error codes.
#pragma once

#include <boost/system/error_code.hpp>

#include <type_traits>

namespace sweepcast::virtual_lidar {

enum class errc {
    world_unreadable = 1,   ///< the file of points cannot be read
    world_malformed,        ///< the file was read, but is not a list of points
    port_unavailable,       ///< the system gave no pseudo terminal
    link_unavailable,       ///< the link to the port cannot be made, or its name is taken
    recording_unavailable,  ///< the recording cannot be written
    capture_unusable,       ///< the file cannot be read, or holds no scan to play
    control_unavailable,    ///< the control socket cannot be made or reached
    not_now,                ///< a command that cannot be obeyed as things are
    invalid_option,         ///< an option has a value that makes no sense
};

/// The category of `errc`, named "sweepcast.virtual".
const boost::system::error_category& virtual_lidar_category();

/// Found by argument-dependent look-up: lets an errc become an error_code.
inline boost::system::error_code make_error_code(errc code) {
    return {static_cast<int>(code), virtual_lidar_category()};
}

}  // namespace sweepcast::virtual_lidar

template <>
struct boost::system::is_error_code_enum<sweepcast::virtual_lidar::errc> : std::true_type {};
