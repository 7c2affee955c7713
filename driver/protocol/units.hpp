// The vendor's fixed-point units as types. The only place that knows their scale.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>

namespace sweepcast::protocol {

/// An angle in 1/65536 turn ("z_q14": degrees * 16384 / 90), clockwise seen from above,
/// 0 at the scanner's front, [0, 360) degrees. Source: protocol.md 7.0.
struct AngleQ14 {
    std::uint16_t raw{};
    [[nodiscard]] constexpr double degrees() const { return raw * (90.0 / 16384.0); }
    auto operator<=>(const AngleQ14&) const = default;
};
static_assert(AngleQ14{16384}.degrees() == 90.0);

/// An angle in 1/64 degree (1/23040 turn), the unit of capsules' start angles. May exceed 360
/// degrees on the wire.
struct AngleQ6 {
    std::uint16_t raw{};
    [[nodiscard]] constexpr double degrees() const { return raw * (1.0 / 64.0); }
    auto operator<=>(const AngleQ6&) const = default;
};
static_assert(AngleQ6{90 * 64}.degrees() == 90.0);

/// A distance in quarter millimetres; 0 means no echo. Source: protocol.md 7.0.
struct DistanceQ2 {
    std::uint32_t raw{};
    [[nodiscard]] constexpr double millimetres() const { return raw * 0.25; }
    [[nodiscard]] constexpr bool has_echo() const { return raw != 0; }
    auto operator<=>(const DistanceQ2&) const = default;
};
static_assert(DistanceQ2{4000}.millimetres() == 1000.0);

/// A moment on the host's monotonic clock, in whole microseconds.
using SampleTime = std::chrono::time_point<std::chrono::steady_clock, std::chrono::microseconds>;

/// A moment on the same clock in nanoseconds: fine enough for the periods of samples and bytes.
using ExactTime = std::chrono::time_point<std::chrono::steady_clock, std::chrono::nanoseconds>;

/// The whole microsecond in which a moment lies.
[[nodiscard]] constexpr SampleTime to_sample_time(ExactTime time) {
    return std::chrono::floor<std::chrono::microseconds>(time);
}

}  // namespace sweepcast::protocol
