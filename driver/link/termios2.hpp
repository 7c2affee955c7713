// The line settings of a serial port, at any baud rate.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstdint>

namespace sweepcast::link {

/// Sets the terminal `fd` to raw 8N1 without flow control at `baud` bits per second, deaf to the
/// modem lines, leaving DTR alone when it is closed. Reads give at least one byte or would block.
/// Gives the speed the driver has really set, which may differ: see close_enough().
/// Errors: the system's own code (ENOTTY if `fd` is no terminal, EIO if no hardware is behind it);
/// EINVAL for speeds of 0, which would hang up the line.
Result<std::uint32_t> set_raw_8n1(int fd, std::uint32_t baud);

/// The speed at which the terminal `fd` sends, in bits per second; asked at the master's end of a
/// pseudo terminal, the one that its other end is set to. Errors: as set_raw_8n1().
Result<std::uint32_t> line_speed(int fd);

/// Whether a UART running at `actual` understands one at `asked`: within 3 %, since a byte of ten
/// bits is sampled in the middle of each bit and both ends share the error.
constexpr bool close_enough(std::uint32_t asked, std::uint32_t actual) {
    const std::uint64_t difference = asked > actual ? asked - actual : actual - asked;
    return difference * 100 <= std::uint64_t{asked} * 3;
}

/// Asks the driver to hand on bytes as they come instead of in bursts, for better sample times.
/// Many drivers do not know it; then nothing changes.
void ask_for_low_latency(int fd);

}  // namespace sweepcast::link
