// SweepProgress: the sweep under way, with how and when it is being taken.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/sweep.hpp"

#include <chrono>
#include <cstdint>
#include <string_view>

namespace sweepcast::device {

/// Everything it refers to is valid only while it is being told.
struct SweepProgress {
    /// All samples so far, never none. They only grow until the sweep is complete, and are then the
    /// first of the CapturedSweep with the same sequence and `begun`. If another `begun` comes
    /// under the same sequence, in a SweepProgress or in a CapturedSweep, the sweep was given up
    /// and what was told of it is void.
    protocol::UnfinishedSweep sweep;
    /// Of the CapturedSweep that it will be.
    std::uint64_t sequence{};
    std::string_view mode;
    protocol::AnswerType answer_type{protocol::AnswerType::normal};
    std::chrono::nanoseconds sample_duration{};
    /// As the CapturedSweep will have them.
    std::chrono::nanoseconds monotonic_to_unix{};
    std::chrono::nanoseconds clock_step{};
    std::chrono::nanoseconds gap{};
    /// When the last byte arrived that was read.
    protocol::SampleTime arrival{};
};

}  // namespace sweepcast::device
