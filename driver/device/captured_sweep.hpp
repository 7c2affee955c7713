// CapturedSweep: a sweep together with where, how and when it was taken. What the driver hands to
// its user.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/sweep.hpp"

#include <chrono>
#include <cstdint>
#include <string>

namespace sweepcast::device {

struct CapturedSweep {
    protocol::Sweep sweep;
    /// Id of the lidar, and its place in the gateway's list, from 1 (the id changes once when the
    /// lidar is identified, the number never).
    std::string lidar;
    std::uint32_t lidar_number{};
    /// Counts this lidar's sweeps from 1.
    std::uint64_t sequence{};
    /// Name of the scan mode, as the lidar gives it.
    std::string mode;
    protocol::AnswerType answer_type{protocol::AnswerType::normal};
    /// From one sample to the next, as the lidar reports it for this mode.
    std::chrono::nanoseconds sample_duration{};
    /// Add it to a sample's time to get UNIX time. Taken once a sweep, when it begins, so that a
    /// step of the wall clock shows between sweeps and never within one.
    std::chrono::nanoseconds monotonic_to_unix{};
    /// By how much the wall clock was set forward (negative: back) since the sweep before, so that
    /// UNIX times of the two do not go together; 0: it was not, or only let run faster or slower.
    std::chrono::nanoseconds clock_step{};
    /// For how long the lidar was not seen before this sweep, where it does not follow on from the
    /// one before: the scan was interrupted or ended meanwhile. 0: it follows on, or is the first.
    std::chrono::nanoseconds gap{};
};

}  // namespace sweepcast::device
