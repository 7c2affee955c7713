// Samples -> capsules of answer type 0x85 (dense), for the virtual lidar.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/units.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace sweepcast::protocol {

inline constexpr std::size_t dense_samples_per_capsule = 40;

/// What one dense capsule holds.
struct DenseCapsule {
    bool restart{};         ///< the angle reference was restarted: first capsule of a stream
    AngleQ6 start_angle{};  ///< of the first sample, 15 bits; the others lie evenly up to the next
                            ///< capsule's
    std::array<std::uint16_t, dense_samples_per_capsule>
        distances_mm{};  ///< whole millimetres; 0: no echo
};

/// The 84 bytes of a capsule. Source: protocol.md 7.2, 7.6.
[[nodiscard]] std::array<std::uint8_t, packet_size(AnswerType::dense)> encode_dense(
    const DenseCapsule& capsule
);

}  // namespace sweepcast::protocol
