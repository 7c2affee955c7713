// Where do packets begin? Finds the alignment of a normal scan (0x81) again after damage.
#pragma once

#include "driver/protocol/normal_packet.hpp"
#include "driver/protocol/units.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace sweepcast::protocol {

/// The most bytes that are looked at for one decision.
inline constexpr std::size_t alignment_window = 40 * normal_packet_size;

/// What is known before the bytes are looked at.
struct AlignmentPrior {
    /// The angle of the last good sample.
    AngleQ14 last_angle{};
    /// Packets are likeliest to begin at the first byte: at the start of a stream, or where angles
    /// jumped all the time before the damage, so that continuity cannot tell and a damaged packet
    /// is likelier than lost bytes.
    bool in_place{};
};

/// What can be said about the first `bytes` of a stream out of step.
struct Alignment {
    enum class Verdict {
        more,     ///< not decided: come again with more bytes
        found,    ///< packets begin at `offset`
        nothing,  ///< none can begin before `offset`, which is at least 1
    };
    Verdict verdict{};
    std::size_t offset{};
};

/// Weighs the five possible alignments of `bytes`, whose first is the beginning of a packet that
/// failed its check bits, or noise.
///
/// Two check bits let one packet of noise in four pass, so each alignment keeps a score: a packet
/// that fails costs 3 (the score stays above 0), one that passes earns 1, or 3 if its angle also
/// continues the one before and it does not claim to start a revolution. An alignment is found when
/// its score reaches 8 while no other has 4: noise gets there about once in a hundred thousand
/// tries, a turning scanner in three or four samples. The verdict depends only on the bytes, not on
/// how they arrive.
[[nodiscard]] Alignment
find_alignment(std::span<const std::uint8_t> bytes, const AlignmentPrior& prior);

}  // namespace sweepcast::protocol
