// ScanReader: the bytes of a running scan -> sweeps, and an account of the line.
#pragma once

#include "driver/device/line_quality.hpp"
#include "driver/device/scan_mode.hpp"
#include "driver/protocol/decode.hpp"
#include "driver/protocol/result.hpp"
#include "driver/protocol/sample_clock.hpp"
#include "driver/protocol/sweep_assembler.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::device {

class ScanReader {
public:
    /// For a stream of `type` (which its descriptor told) in `mode`, over a line of `baud` bits a
    /// second (0: a network). What comes is added to `line`, which outlives this.
    /// Errors: protocol::errc::unsupported_answer_type.
    static Result<ScanReader>
    create(protocol::AnswerType type, const ScanMode& mode, std::uint32_t baud, LineQuality& line);

    /// Takes bytes whose last one arrived at `now`; appends the sweeps that they complete to
    /// `finished`. Gives how many samples there were. A distance beyond the mode's range becomes no
    /// echo (protocol.md 13.13); times are those of a SampleClock.
    std::size_t push(
        std::span<const std::uint8_t> bytes,
        protocol::SampleTime now,
        std::vector<protocol::Sweep>& finished
    );

    /// The revolution under way. Valid until the next push().
    [[nodiscard]] protocol::UnfinishedSweep unfinished() const { return assembler_.unfinished(); }

private:
    ScanReader(
        protocol::Decoder decoder,
        protocol::SampleClock clock,
        double max_distance_mm,
        std::uint32_t baud,
        LineQuality& line
    );

    void clip_range();
    void account_for(std::size_t bytes);

    protocol::Decoder decoder_;
    protocol::SampleClock clock_;
    protocol::SweepAssembler assembler_;
    protocol::Decoded decoded_;
    std::chrono::nanoseconds per_byte_;
    std::uint32_t max_distance_q2_;
    LineQuality* line_;
};

}  // namespace sweepcast::device
