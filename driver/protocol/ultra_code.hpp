// The numbers inside ultra capsules (0x84): distances in a 12-bit code of variable scale,
// differences in units of that scale, and the angle that depends on the distance. Source:
// protocol.md 7.5.
#pragma once

#include "driver/protocol/units.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace sweepcast::protocol {

inline constexpr std::size_t ultra_cabins_per_capsule = 32;
inline constexpr std::size_t ultra_samples_per_capsule = 3 * ultra_cabins_per_capsule;

/// A range of codes whose steps are 2^level millimetres.
struct UltraScale {
    std::int32_t first_code{};
    std::int32_t first_mm{};
    std::int32_t level{};
};

/// From near to far. The last code, 4095, means 28656 mm.
inline constexpr std::array<UltraScale, 5> ultra_scales{
    {{.first_code = 0, .first_mm = 0, .level = 0},
     {.first_code = 512, .first_mm = 512, .level = 1},
     {.first_code = 1280, .first_mm = 2048, .level = 2},
     {.first_code = 1792, .first_mm = 4096, .level = 3},
     {.first_code = 3328, .first_mm = 16384, .level = 4}}};
inline constexpr std::int32_t ultra_last_code = 4095;

/// What a code says: a distance, and the scale of what is told relative to it.
struct UltraMajor {
    std::int32_t mm{};  ///< 0: no echo
    std::int32_t level{};
};

/// The meaning of a 12-bit code.
[[nodiscard]] constexpr UltraMajor ultra_major(std::int32_t code) {
    auto scale = ultra_scales[0];
    for (const auto& next : ultra_scales) {
        scale = code >= next.first_code ? next : scale;
    }
    return {scale.first_mm + ((code - scale.first_code) << scale.level), scale.level};
}

/// Differences: 10 bits, two's complement. The extremes mean no echo.
inline constexpr std::int32_t ultra_no_echo = -512;
inline constexpr std::int32_t ultra_no_echo_too = 511;

/// By how much the angle of a sample lies before its evenly spread place, in 1/65536 degree: the
/// geometry of triangulation. `distance_q2` may be zero or negative.
[[nodiscard]] constexpr std::int32_t ultra_angle_offset_q16(std::int32_t distance_q2) {
    constexpr std::int32_t nearest_q2 = 200;  // 50 mm
    std::int32_t radians_q16 = 8578;          // 7.5 degrees
    if (distance_q2 >= nearest_q2) {
        const std::int32_t k2 = 98361 / distance_q2;
        radians_q16 = 9150 - (k2 << 6) - k2 * k2 * k2 / 98304;  // 8 degrees and less
    }
    // Not pi: the digits that the vendor's decoder divides by.
    return static_cast<std::int32_t>(radians_q16 * 180 / 3.14159265);
}

}  // namespace sweepcast::protocol
