// The layout of ultra-dense capsules (0x86) and the scales of their distances. Source:
// protocol.md 7.7.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sweepcast::protocol {

inline constexpr std::size_t ultra_dense_samples_per_capsule = 64;
inline constexpr std::size_t ultra_dense_time_stamp_at = 2;  ///< four bytes
inline constexpr std::size_t ultra_dense_status_at = 6;      ///< two bytes
inline constexpr std::size_t ultra_dense_start_at = 8;       ///< the start word
/// Cabins of two samples: the low 16 bits of each, then a byte with the high 4 bits of both.
inline constexpr std::size_t ultra_dense_cabins_at = 10;
inline constexpr std::size_t ultra_dense_cabin_size = 5;

/// One way to divide the 20 bits of a sample, chosen by the lowest two: above them `distance_bits`
/// of distance, and above those the quality's highest bits.
struct UltraDenseScale {
    std::int32_t first_mm{};  ///< what distance 0 means
    std::int32_t step_mm{};
    unsigned distance_bits{};

    [[nodiscard]] constexpr std::int32_t last_mm() const {
        return first_mm + step_mm * ((1 << distance_bits) - 1);
    }
};

/// By the lowest two bits.
inline constexpr std::array<UltraDenseScale, 4> ultra_dense_scales{
    {{.first_mm = 0, .step_mm = 2, .distance_bits = 10},
     {.first_mm = 2046, .step_mm = 3, .distance_bits = 11},
     {.first_mm = 8187, .step_mm = 4, .distance_bits = 12},
     {.first_mm = 24567, .step_mm = 5, .distance_bits = 13}}};

}  // namespace sweepcast::protocol
