// What can go wrong on a link to a device.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstdint>
#include <type_traits>

namespace sweepcast::link {

enum class errc : std::uint8_t {
    timed_out = 1,       ///< the deadline passed first
    interrupted,         ///< interrupt(), close() or cancellation ended the operation
    disconnected,        ///< the other side is gone: end of file, hang-up, unplugged, unreachable
    no_modem_lines,      ///< the line has no DTR, e.g. a pseudo-terminal
    no_line_speed,       ///< the line has no baud rate, e.g. a network connection
    port_not_found,      ///< nothing at this path
    permission_denied,   ///< the port exists but we may not open it
    port_busy,           ///< someone else holds the port
    not_a_serial_port,   ///< a file, a directory or another kind of device
    baud_not_supported,  ///< the adapter cannot run at this speed
    io_error,            ///< opening failed for another reason, which the problem tells
    host_not_found,      ///< nobody knows an address for this name
    connection_refused,  ///< the host is there, but nothing listens on this port of it
    unreachable,         ///< no way leads to the host, or nobody answers for its address
};

/// The category of errc, "sweepcast.link"; its messages are fit for an operator.
const boost::system::error_category& link_category();

inline error_code make_error_code(errc value) {
    return {static_cast<int>(value), link_category()};
}

}  // namespace sweepcast::link

template <>
struct boost::system::is_error_code_enum<sweepcast::link::errc> : std::true_type {};
