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
    std::int32_t mm{};    ///< 0: no echo
    std::int32_t step{};  ///< millimetres
};

/// Scales begin at multiples of 256, so the highest four bits of a code choose its scale:
/// mm = code * step + bias.
struct UltraLine {
    std::int32_t step{};
    std::int32_t bias{};
};
inline constexpr auto ultra_lines = [] {
    std::array<UltraLine, 16> lines{};
    for (const auto& scale : ultra_scales) {
        for (auto i = static_cast<std::size_t>(scale.first_code) / 256; i < lines.size(); ++i) {
            const auto step = 1 << scale.level;
            lines[i] = {step, scale.first_mm - scale.first_code * step};
        }
    }
    return lines;
}();

/// The meaning of a 12-bit code.
[[nodiscard]] constexpr UltraMajor ultra_major(std::int32_t code) {
    const auto line = ultra_lines[static_cast<std::size_t>(code >> 8 & 15)];
    return {code * line.step + line.bias, line.step};
}

/// Differences: 10 bits, two's complement. The extremes mean no echo.
inline constexpr std::int32_t ultra_no_echo = -512;
inline constexpr std::int32_t ultra_no_echo_too = 511;

/// The nearest distance whose angle depends on it: 50 mm.
inline constexpr std::int32_t ultra_near_limit_q2 = 200;
/// How near a sample is, in the units that its angle depends on, goes from 0, far away, to this,
inline constexpr std::int32_t ultra_nearest = 98361 / ultra_near_limit_q2;
/// or is this for what is nearer still, has no echo or is negative.
inline constexpr std::int32_t ultra_too_near = ultra_nearest + 1;

/// How near a sample at this distance is.
[[nodiscard]] constexpr std::int32_t ultra_nearness(std::int32_t distance_q2) {
    const bool too_near = distance_q2 < ultra_near_limit_q2;
    const auto divisor = too_near ? ultra_near_limit_q2 : distance_q2;
    // The same as dividing integers, but several can be done at once: the quotient is never so
    // little below a whole number that it would be rounded up to it.
    const auto quotient = static_cast<std::int32_t>(98361.0F / static_cast<float>(divisor));
    return too_near ? ultra_too_near : quotient;
}

/// By how much the angle of a sample so near lies before its evenly spread place, in 1/65536
/// degree: the geometry of triangulation.
inline constexpr auto ultra_offsets_q16 = [] {
    std::array<std::int32_t, ultra_too_near + 1> offsets{};
    for (std::int32_t near = 0; near <= ultra_too_near; ++near) {
        const std::int32_t radians_q16 =
            near == ultra_too_near ? 8578                                            // 7.5 degrees
                                   : 9150 - near * 64 - near * near * near / 98304;  // 8 and less
        // Not pi: the digits that the vendor's decoder divides by.
        offsets[static_cast<std::size_t>(near)] =
            static_cast<std::int32_t>(radians_q16 * 180 / 3.14159265);
    }
    return offsets;
}();

/// The same from a distance, which may be zero or negative.
[[nodiscard]] constexpr std::int32_t ultra_angle_offset_q16(std::int32_t distance_q2) {
    return ultra_offsets_q16[static_cast<std::size_t>(ultra_nearness(distance_q2))];
}

}  // namespace sweepcast::protocol
