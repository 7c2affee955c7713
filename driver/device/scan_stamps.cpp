#include "driver/device/scan_stamps.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::device {

void ScanStamps::begin_scan(const ScanMode& mode) {
    mode_ = mode;
    begun_before_scan_ = begun_;
    after_gap_ = true;
}

CapturedSweep ScanStamps::stamp(protocol::Sweep sweep, protocol::AnswerType type) {
    if (!sweep.samples.empty()) {
        begin_sweep(sweep.begun, sweep.samples.front().time);
        last_seen_ = sweep.samples.back().time;
    }
    after_gap_ = false;
    CapturedSweep captured;
    captured.sweep = std::move(sweep);
    captured.sweep.begun = begun_;
    captured.mode = mode_.name;
    captured.answer_type = type;
    captured.sample_duration = mode_.sample_duration;
    captured.monotonic_to_unix = monotonic_to_unix_;
    captured.clock_step = std::exchange(clock_step_, {});
    captured.gap = std::exchange(gap_, {});
    captured.sequence = ++sequence_;
    return captured;
}

SweepProgress ScanStamps::stamp(
    const protocol::UnfinishedSweep& sweep,
    protocol::AnswerType type,
    protocol::SampleTime arrival
) {
    begin_sweep(sweep.begun, sweep.samples.front().time);
    SweepProgress progress;
    progress.sweep = sweep;
    progress.sweep.begun = begun_;
    progress.sequence = sequence_ + 1;
    progress.mode = mode_.name;
    progress.answer_type = type;
    progress.sample_duration = mode_.sample_duration;
    progress.monotonic_to_unix = monotonic_to_unix_;
    progress.clock_step = clock_step_;
    progress.gap = gap_;
    progress.arrival = arrival;
    return progress;
}

/// Notes which sweep of the scan is under way; reads the clocks once for each.
void ScanStamps::begin_sweep(std::uint64_t begun, protocol::SampleTime first) {
    begun += begun_before_scan_;
    if (begun == begun_) {
        return;
    }
    begun_ = begun;
    const auto relation = wall_clock_.take(read_clocks());
    monotonic_to_unix_ = relation.monotonic_to_unix;
    clock_step_ += relation.step;  // a sweep that is given up leaves it to the next one
    gap_ = {};
    if (after_gap_ && last_seen_) {
        gap_ = std::max(first - *last_seen_, protocol::SampleTime::duration::zero());
    }
}

}  // namespace sweepcast::device
