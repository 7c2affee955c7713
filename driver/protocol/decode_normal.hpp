// Bytes of answer type 0x81 (normal) -> samples.
#pragma once

#include "driver/protocol/backlog.hpp"
#include "driver/protocol/decoded.hpp"
#include "driver/protocol/normal_alignment.hpp"
#include "driver/protocol/sample_timing.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace sweepcast::protocol {

/// Decodes a normal scan: five bytes, one sample. Source: protocol.md 7.1, 8.
///
/// An undamaged stream gives bit for bit what the vendor's decoder gives. A packet puts the decoder
/// out of step if it fails its check bits, or if its angle jumps after a streak of angles that did
/// not: the commonest sign that bytes were lost inside it. The decoder then gives out nothing until
/// find_alignment() is sure where packets begin, and goes on from the first of them, which may be
/// the one that jumped. Samples come late then, but with the time they arrived. A stream begins out
/// of step too: its first sample comes with its second. Once in step, each sample comes out at
/// once. What no check can show: a packet that lost bytes of its distance comes out with a wrong
/// one.
class NormalDecoder {
public:
    explicit NormalDecoder(const DecodeSettings& settings);

    /// Appends to `out` what `bytes` complete.
    void push(std::span<const std::uint8_t> bytes, const Arrival& arrival, Decoded& out);

private:
    /// How the angles of consecutive samples go on.
    struct AngleTrack {
        AngleQ14 last{};
        std::uint32_t streak{};  ///< samples in a row, since in step, that continued the one before
        std::uint32_t roughness{};  ///< rises by two with a jump, falls by one with a continuation

        /// Takes the next angle in, unless it contradicts a streak.
        [[nodiscard]] bool take(AngleQ14 angle);
    };

    std::size_t step(const TimedBytes& input, Decoded& out);
    std::size_t decode_run(const TimedBytes& input, Decoded& out);
    void lose_step();
    std::size_t realign(const TimedBytes& input, Decoded& out);

    SampleTiming timing_;
    Backlog<alignment_window> backlog_;
    AngleTrack track_;
    bool in_step_{};
    AlignmentPrior prior_{.last_angle = {}, .in_place = true};  ///< while out of step
};

}  // namespace sweepcast::protocol
