// Bytes of answer type 0x81 (normal) -> samples.
#pragma once

#include "driver/protocol/backlog.hpp"
#include "driver/protocol/decoded.hpp"
#include "driver/protocol/normal_alignment.hpp"
#include "driver/protocol/sample_timing.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sweepcast::protocol {

/// Decodes a normal scan: five bytes, one sample, given out at once. Source: protocol.md 7.1, 8.
///
/// An undamaged stream gives bit for bit what the vendor's decoder gives. A packet that fails its
/// check bits puts the decoder out of step; it then gives out nothing until find_alignment() is
/// sure where packets begin, and goes on from the first of them. Samples come late then, but with
/// the time they arrived. Bytes that belonged to no packet are reported when the step is found
/// again, or the window is full.
class NormalDecoder {
public:
    explicit NormalDecoder(const DecodeSettings& settings);

    /// Appends to `out` what `bytes` complete.
    void push(std::span<const std::uint8_t> bytes, const Arrival& arrival, Decoded& out);

private:
    /// The angles of the last samples, oldest first.
    struct RecentAngles {
        std::array<AngleQ14, 4> angles{};
        std::size_t count{};

        void add(AngleQ14 angle);
        [[nodiscard]] AlignmentPrior prior() const;
    };

    std::size_t step(const TimedBytes& input, Decoded& out);
    std::size_t decode_run(const TimedBytes& input, Decoded& out);
    std::size_t realign(const TimedBytes& input, Decoded& out);

    SampleTiming timing_;
    Backlog<alignment_window> backlog_;
    RecentAngles recent_;
    bool in_step_{true};
    AlignmentPrior prior_;
};

}  // namespace sweepcast::protocol
