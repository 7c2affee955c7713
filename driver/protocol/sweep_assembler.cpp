// Cutting a stream of samples into revolutions, by the angle itself. The state table is in the
// header.
#include "driver/protocol/sweep_assembler.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::protocol {
namespace {

constexpr std::int64_t turn = 65536;
constexpr std::int64_t half_turn = turn / 2;
/// A step beyond this, either way, is not believed without confirmation.
constexpr std::int64_t greatest_step = turn / 8;
/// Samples out of line in a row, none of them continuing another, that are taken for noise.
constexpr int most_undecided = 4;

/// The shorter way from one angle to the other, forward positive.
std::int64_t shorter_way(std::uint16_t from, std::uint16_t to) {
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(to - from));
}

/// The way from one angle to the other as a lidar turns: always forward.
std::int64_t way_forward(std::uint16_t from, std::uint16_t to) {
    return static_cast<std::uint16_t>(to - from);
}

bool in_line(std::int64_t step) {
    return step >= -greatest_step && step <= greatest_step;
}

}  // namespace

void SweepAssembler::push(const Decoded& decoded, std::vector<Sweep>& finished) {
    pushed_uncertainty_ = decoded.time_uncertainty;
    std::size_t next_event = 0;
    const auto apply_events_up_to = [&](std::size_t sample) {
        for (; next_event < decoded.events.size() && decoded.events[next_event].at_sample <= sample;
             ++next_event) {
            apply(decoded.events[next_event]);
        }
    };
    for (std::size_t i = 0; i < decoded.samples.size(); ++i) {
        apply_events_up_to(i);
        take(decoded.samples[i], finished);
    }
    apply_events_up_to(decoded.samples.size());
}

void SweepAssembler::recycle(Sweep&& spent) {
    if (spent.samples.capacity() > spare_.capacity()) {
        spare_ = std::move(spent.samples);
    }
}

void SweepAssembler::apply(const DecodeEvent& event) {
    losses_.count(event);
    if (event.kind == DecodeEventKind::scan_reset) {
        restart();
    }
}

void SweepAssembler::restart() {
    if (state_ != State::searching) {
        discard(samples_.size() + (suspect_ ? 1 : 0));
    }
    samples_.clear();
    suspect_.reset();
    angle_.reset();
    undecided_ = 0;
    state_ = State::searching;
}

void SweepAssembler::take(const Sample& sample, std::vector<Sweep>& finished) {
    if (!angle_) {
        start_following(sample);
        return;
    }
    if (suspect_) {
        judge_suspect(sample, finished);
    }
    const auto step = shorter_way(*angle_, sample.angle.raw);
    if (in_line(step)) {
        undecided_ = 0;
        follow(sample, step, finished);
    } else {
        suspect_ = sample;
    }
}

/// Begins to follow the angle, knowing nothing of what was before.
void SweepAssembler::start_following(const Sample& sample) {
    angle_ = sample.angle.raw;
    position_ = sample.angle.raw;
    next_zero_ = turn;
    if (sample.starts_revolution()) {
        begin_sweep();
        add(sample);
    }
}

/// Decides about the sample out of line, now that the one after it is known.
void SweepAssembler::judge_suspect(const Sample& next, std::vector<Sweep>& finished) {
    const auto suspect = *std::exchange(suspect_, std::nullopt);
    const bool goes_on_before = in_line(shorter_way(*angle_, next.angle.raw));
    const bool goes_on_after = in_line(shorter_way(suspect.angle.raw, next.angle.raw));
    if (goes_on_before || (!goes_on_after && ++undecided_ < most_undecided)) {
        add(suspect);
        return;
    }
    undecided_ = 0;
    if (state_ == State::searching) {
        // What was followed so far may have been the noise: no beginning can be read from the jump.
        start_following(suspect);
    } else {
        follow(suspect, way_forward(*angle_, suspect.angle.raw), finished);
    }
}

/// Takes a sample whose angle is believed.
void SweepAssembler::follow(
    const Sample& sample,
    std::int64_t advance,
    std::vector<Sweep>& finished
) {
    position_ += advance;
    angle_ = sample.angle.raw;
    if (begins_sweep(sample)) {
        finish_sweep(sample, finished);
        begin_sweep();
    }
    add(sample);
}

bool SweepAssembler::begins_sweep(const Sample& sample) const {
    if (position_ >= next_zero_) {
        return true;
    }
    return sample.starts_revolution() &&
           (state_ == State::searching || position_ >= mark_counts_from_);
}

/// Gives out the sweep gathered, if any; `next` is the first sample after it.
void SweepAssembler::finish_sweep(const Sample& next, std::vector<Sweep>& finished) {
    if (state_ != State::gathering) {
        return;
    }
    const auto period = next.time - samples_.front().time;
    finished.push_back(
        {std::exchange(samples_, std::exchange(spare_, {})), period, losses_, begun_, uncertainty_}
    );
    losses_ = {};
}

/// Begins a sweep at the present position, which is counted anew from heading 0.
void SweepAssembler::begin_sweep() {
    samples_.clear();
    uncertainty_ = {};
    ++begun_;
    state_ = State::gathering;
    position_ = *angle_;
    mark_counts_from_ = position_ + half_turn;
    next_zero_ = mark_counts_from_ <= turn ? turn : 2 * turn;
}

void SweepAssembler::add(const Sample& sample) {
    switch (state_) {
    case State::searching:
        return;
    case State::overgrown:
        discard(1);
        return;
    case State::gathering:
        break;
    }
    if (samples_.size() == max_sweep_samples) {
        discard(samples_.size() + 1);
        samples_.clear();
        state_ = State::overgrown;
        return;
    }
    samples_.push_back(sample);
    uncertainty_ = std::max(uncertainty_, pushed_uncertainty_);
}

}  // namespace sweepcast::protocol
