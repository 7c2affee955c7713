// DecodedScan: a scan as its reader gets it.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/sample.hpp"
#include "driver/protocol/sweep.hpp"

#include <chrono>
#include <string>

namespace sweepcast::frame {

/// A scan as its reader gets it.
struct DecodedScan {
    /// Exactly what was put in; with coarser units the nearest there is to it.
    protocol::Sweep sweep;
    std::string mode;
    protocol::AnswerType answer_type{protocol::AnswerType::normal};
    /// The usual time from one sample to the next, as the lidar reports it.
    std::chrono::nanoseconds sample_duration{};
    /// When the first sample was taken, since the UNIX epoch; 0 if not known.
    std::chrono::nanoseconds first_unix{};
    /// By how much the wall clock was set since the scan before; 0: it was not.
    std::chrono::nanoseconds clock_step{};
    /// For how long the lidar was not seen before this sweep; 0: it follows on from the one before.
    std::chrono::nanoseconds gap{};
    /// Columns that are not there. Times are sample_duration apart then.
    bool without_quality{};
    bool without_flags{};
    bool without_times{};

    /// When a sample of this scan was taken, since the UNIX epoch; 0 if not known.
    [[nodiscard]] std::chrono::nanoseconds unix_time(const protocol::Sample& sample) const {
        return first_unix.count() == 0 ? first_unix
                                       : first_unix + (sample.time - sweep.samples.front().time);
    }
};

}  // namespace sweepcast::frame
