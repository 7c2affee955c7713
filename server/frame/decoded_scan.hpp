// DecodedScan: a scan as its reader gets it.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/sample.hpp"
#include "driver/protocol/sweep.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
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
    /// When the earliest sample was taken, on the clock of `Sample::time`. That is the first
    /// sample, except in a scan with bins, which begins at angle 0 wherever the lidar began.
    protocol::SampleTime first_time{};
    /// The same moment since the UNIX epoch; 0 if not known.
    std::chrono::nanoseconds first_unix{};
    /// By how much the wall clock was set since the scan before; 0: it was not.
    std::chrono::nanoseconds clock_step{};
    /// For how long the lidar was not seen before this sweep; 0: it follows on from the one before.
    std::chrono::nanoseconds gap{};
    /// The unit of the angles on the wire: this many are a full circle.
    std::uint32_t angle_units_per_turn{};
    /// Columns that are missing. Without quality or flags, those of every sample are 0. Without
    /// times, only `first_time` and `first_unix` are known, and the `time` of every sample is
    /// `first_time`. The time between two samples of a filtered scan is then unknown.
    bool without_quality{};
    bool without_flags{};
    bool without_times{};

    /// Returns when a sample of this scan was taken, since the UNIX epoch. None if that is not
    /// known: the scan came without times, or the gateway does not know the wall clock's time.
    [[nodiscard]] std::optional<std::chrono::nanoseconds> unix_time(const protocol::Sample& sample
    ) const {
        if (without_times || first_unix.count() == 0) {
            return std::nullopt;
        }
        return first_unix + (sample.time - first_time);
    }

    /// Returns the angle of a sample of this scan in degrees. In units that the subscriber chose
    /// (those of bins too) it is exact, where `sample.angle` is the nearest 1/65536 turn. In the
    /// lidar's units, 23040 and 65536 per turn, it is `sample.angle`, which is the vendor's value.
    [[nodiscard]] double degrees(const protocol::Sample& sample) const;
};

}  // namespace sweepcast::frame
