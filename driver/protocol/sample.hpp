// Sample: one measurement, the value that every room of the driver and the server shares.
#pragma once

#include "driver/protocol/units.hpp"

#include <cstdint>

namespace sweepcast::protocol {

/// One measurement as decoded, bit for bit what the vendor's decoder gives (protocol.md 7.0), with
/// a time of its own.
struct Sample {
    /// When the measurement was taken, on the host's monotonic clock (protocol.md 8).
    SampleTime time{};
    DistanceQ2 distance{};
    AngleQ14 angle{};
    /// Strength of the echo, 0..255; types that do not measure it report 188 with an echo and 0
    /// without.
    std::uint8_t quality{};
    /// Bit 0: first sample of a revolution. Bit 1: not the first (set by some answer types only).
    std::uint8_t flag{};

    [[nodiscard]] constexpr bool starts_revolution() const { return (flag & 1U) != 0; }
    bool operator==(const Sample&) const = default;
};
static_assert(sizeof(Sample) == 16);

}  // namespace sweepcast::protocol
