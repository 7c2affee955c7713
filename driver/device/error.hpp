// What can go wrong in a lidar's life above the line: it does not answer, or not as it should.
#pragma once

#include <boost/system/error_code.hpp>

namespace sweepcast::device {

enum class errc {
    no_answer = 1,    ///< a request went unanswered
    stream_silent,    ///< the scan was started but no samples come
    not_turning,      ///< samples come, but no revolutions
    protection_stop,  ///< the lidar reports a fault and has switched itself off
    unknown_mode,     ///< no scan mode of that name
    not_ready,        ///< the lidar cannot do it, and the command is not kept
    pending,          ///< the command is kept, and takes effect as soon as the lidar can obey
    no_such_speed,    ///< a rotation speed beyond what the lidar is made for
    fixed_speed,      ///< the rotation speed of this lidar cannot be changed
    baud_refused,     ///< the lidar would not be talked into another line speed
    superseded,       ///< another command came before this one took effect
    shutting_down,    ///< the gateway is ending
    internal,         ///< a fault of ours
    another_lidar,    ///< not the one that is expected at this port
};

boost::system::error_code make_error_code(errc code);

}  // namespace sweepcast::device

template <>
struct boost::system::is_error_code_enum<sweepcast::device::errc> : std::true_type {};
