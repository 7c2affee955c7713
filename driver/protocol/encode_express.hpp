// Samples -> capsules of answer type 0x82 (express), for the virtual lidar.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/units.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace sweepcast::protocol {

inline constexpr std::size_t express_samples_per_capsule = 32;

/// One sample of an express capsule.
struct ExpressSample {
    std::uint16_t distance_mm{};  ///< 0..16383; 0: no echo
    std::uint8_t
        angle_offset_q3{};  ///< 0..63 eighths of a degree, subtracted from the interpolated angle
};

/// What one express capsule holds.
struct ExpressCapsule {
    bool restart{};         ///< the angle reference was restarted: first capsule of a stream
    AngleQ6 start_angle{};  ///< of the first sample, 15 bits; the others lie evenly up to the next
                            ///< capsule's
    std::array<ExpressSample, express_samples_per_capsule> samples{};
};

/// The 84 bytes of a capsule. Values are cut to the bits of their fields. Source:
/// protocol.md 7.2, 7.3.
[[nodiscard]] std::array<std::uint8_t, packet_size(AnswerType::express)> encode_express(
    const ExpressCapsule& capsule
);

}  // namespace sweepcast::protocol
