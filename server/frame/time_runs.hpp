// The times of samples as runs of equal steps: what a steady clock takes few numbers for.
#pragma once

#include "driver/protocol/sample.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::frame {

/// A step that is taken some times in a row.
struct TimeRun {
    std::uint32_t count{};
    std::int64_t step_ps{};
    bool operator==(const TimeRun&) const = default;
};

/// Picoseconds of a microsecond.
constexpr std::int64_t ps_per_us = 1'000'000;
/// How far from the beginning a sample may be; one farther away (53 days) counts as this far.
constexpr std::int64_t farthest_us = std::int64_t{1} << 42;

/// Replaces `runs` by runs of steps, one step before each sample, the first sample included. Their
/// sums, counted from `begin`, lead into the microsecond of each sample. Each straight line is as
/// long as can be. Source: for lines through vertical segments, J. O'Rourke, "An on-line algorithm
/// for fitting straight lines between data ranges", CACM 24 (1981).
void to_time_runs(
    std::span<const protocol::Sample> samples,
    protocol::SampleTime begin,
    std::vector<TimeRun>& runs
);

}  // namespace sweepcast::frame
