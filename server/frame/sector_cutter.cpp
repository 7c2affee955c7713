#include "server/frame/sector_cutter.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::frame {

namespace {

constexpr std::int64_t units_per_turn = 65536;
constexpr std::int64_t mdeg_per_turn = 360'000;
/// Farther from the sample before than this, forward or back, is out of line (as SweepAssembler
/// has it).
constexpr std::int64_t most_in_line = units_per_turn / 8;

std::int64_t way_forward(std::uint16_t from, std::uint16_t to) {
    return static_cast<std::uint16_t>(to - from);
}

std::int64_t shorter_way(std::uint16_t from, std::uint16_t to) {
    const auto forward = way_forward(from, to);
    return forward > units_per_turn / 2 ? forward - units_per_turn : forward;
}

bool in_line(std::int64_t way) {
    return way >= -most_in_line && way <= most_in_line;
}

}  // namespace

SectorCutter::SectorCutter(const Wish& wish)
    : sector_mdeg_(wish.sector_mdeg)
    , max_latency_(wish.max_latency) {}

std::optional<Slice> SectorCutter::cut(const device::SweepProgress& progress) {
    const auto samples = progress.sweep.samples;
    begin(progress.sweep.begun, samples.size());
    for (; followed_ < samples.size(); ++followed_) {
        follow(samples[followed_]);
    }
    const bool is_due = samples.size() > cut_ && (is_far_enough() || would_wait_too_long(progress));
    last_arrival_ = progress.arrival;
    if (!is_due) {
        return std::nullopt;
    }
    if (sector_mdeg_ > 0) {
        const auto passed = std::max<std::int64_t>(position_, 0) * mdeg_per_turn / units_per_turn;
        sectors_ = std::max(sectors_, static_cast<std::uint32_t>(passed / sector_mdeg_));
    }
    return Slice{std::exchange(cut_, samples.size()), samples.size(), false};
}

Slice SectorCutter::finish(const device::CapturedSweep& captured) {
    const auto count = captured.sweep.samples.size();
    begin(captured.sweep.begun, count);
    begun_.reset();
    return {cut_, count, true};
}

/// Starts over unless `samples` are those of the sweep under way, grown.
void SectorCutter::begin(std::uint64_t begun, std::size_t samples) {
    if (begun_ == begun && samples >= followed_) {
        return;
    }
    begun_ = begun;
    cut_ = 0;
    followed_ = 0;
    suspect_.reset();
    position_ = 0;
    sectors_ = 0;
}

void SectorCutter::follow(const protocol::Sample& sample) {
    const auto angle = sample.angle.raw;
    if (followed_ == 0) {
        angle_ = angle;
        return;
    }
    const auto way = shorter_way(angle_, angle);
    const bool was_real_jump = suspect_ && in_line(shorter_way(*suspect_, angle));
    if (!in_line(way) && !was_real_jump) {
        suspect_ = angle;
        return;
    }
    position_ += in_line(way) ? way : way_forward(angle_, angle);
    angle_ = angle;
    suspect_.reset();
}

bool SectorCutter::is_far_enough() const {
    if (sector_mdeg_ == 0) {
        return false;
    }
    const auto next_mdeg = (std::int64_t{sectors_} + 1) * sector_mdeg_;
    return next_mdeg < mdeg_per_turn && position_ * mdeg_per_turn >= next_mdeg * units_per_turn;
}

bool SectorCutter::would_wait_too_long(const device::SweepProgress& progress) const {
    if (max_latency_.count() == 0) {
        return false;
    }
    // The next read is expected after as long as this one took to come.
    const auto next_read = last_arrival_ ? progress.arrival - *last_arrival_ : max_latency_;
    const auto oldest = progress.sweep.samples[cut_].time;
    return progress.arrival + next_read - oldest > max_latency_;
}

}  // namespace sweepcast::frame
