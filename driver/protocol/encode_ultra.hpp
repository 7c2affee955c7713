// Samples -> capsules of answer type 0x84 (ultra), for the virtual lidar.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/ultra_code.hpp"
#include "driver/protocol/units.hpp"

#include <array>
#include <cstdint>

namespace sweepcast::protocol {

/// What one ultra capsule holds. A receiver computes the angles: sample k lies k/96 of the way from
/// this start angle to the next capsule's, less ultra_angle_offset_q16() of its distance.
struct UltraCapsule {
    bool restart{};         ///< the angle reference was restarted: first capsule of a stream
    AngleQ6 start_angle{};  ///< 15 bits
    /// Whole millimetres; 0: no echo. Samples 3c, 3c+1 and 3c+2 share a cabin.
    std::array<std::uint16_t, ultra_samples_per_capsule> distances_mm{};
};

/// The 132 bytes of a capsule; `next_distance_mm` is the first distance of the capsule after it,
/// to which the last sample is relative. Source: protocol.md 7.2, 7.5.
///
/// Not every distance can be told:
///  - the first of a cabin (its major) is rounded to the nearest code. Greatest error: none up to
///    512 mm, 1 mm up to 2048, 2 mm up to 4096, 4 mm up to 16384, 8 mm up to 28663. What is farther
///    comes out as no echo;
///  - the second is told relative to the major of its own cabin (if that has no echo: of the next
///    cabin), the third relative to the major of the next cabin, each by up to -511 or +510 steps
///    of that major's scale: the error is at most half such a step (8 mm at the farthest scale; an
///    echo is never rounded to 0). What is out of this reach, or has no echo to be relative to and
///    is beyond 510 mm, comes out as no echo, since a wall is better missed than seen in a wrong
///    place.
[[nodiscard]] std::array<std::uint8_t, packet_size(AnswerType::ultra)>
encode_ultra(const UltraCapsule& capsule, std::uint16_t next_distance_mm);

}  // namespace sweepcast::protocol
