// What a UART makes of bytes that were sent at another speed than it listens at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::virtual_lidar {

/// Whether a UART can read what is sent at a speed that is off by so little. 0 stands for a line
/// that has no speed, which fits any.
[[nodiscard]] bool speeds_fit(std::uint32_t sent_baud, std::uint32_t heard_baud);

/// The bytes that a receiver at `heard_baud` gets when `bytes` are sent back to back at
/// `sent_baud`: start bit, eight bits from the lowest on, stop bit, each sampled at its middle. A
/// byte whose stop bit is wrong is passed on as it is, as Linux does by default. The same bytes if
/// speeds_fit(). Both speeds are at most 2^31.
[[nodiscard]] std::vector<std::uint8_t>
heard(std::span<const std::uint8_t> bytes, std::uint32_t sent_baud, std::uint32_t heard_baud);

}  // namespace sweepcast::virtual_lidar
