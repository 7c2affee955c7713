// What is known of USB serial adapters.
#pragma once

#include <cstdint>

namespace sweepcast::diagnosis {

/// USB vendor ids of the two adapters that RPLIDARs are sold with: CP210x and CH340.
inline constexpr std::uint16_t silicon_labs = 0x10c4;
inline constexpr std::uint16_t qinheng = 0x1a86;

/// The baud rate of a C1. Adapters differ in whether they can run at this rate and above.
inline constexpr std::uint32_t fast_baud = 460800;

}  // namespace sweepcast::diagnosis
