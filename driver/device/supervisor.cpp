#include "driver/device/supervisor.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace sweepcast::device {

namespace {

bool is_well(Phase phase) {
    return phase == Phase::idle || phase == Phase::scanning;
}

/// Whether being there means that something is wrong; the others are on the way, or at the end.
bool is_trouble(Phase phase) {
    return phase == Phase::absent || phase == Phase::stalled || phase == Phase::protection_stop ||
           phase == Phase::backing_off || phase == Phase::failed;
}

}  // namespace

Supervisor::Supervisor(Life& life, RecoveryPolicy policy, std::uint64_t seed)
    : life_(life)
    , policy_(policy)
    , random_(seed) {
    life_.since = std::chrono::system_clock::now();
}

bool Supervisor::on(Event event, const Problem& why, Moment now) {
    const auto phase = next(life_.phase, event);
    if (!phase) {
        throw std::logic_error(
            fmt::format("\"{}\" must not happen while {}", name(event), name(life_.phase))
        );
    }
    const bool on_the_way =
        !is_well(*phase) && !is_trouble(*phase) && *phase != Phase::disconnected;
    const bool no_news = *phase == life_.phase && is_trouble(*phase);
    const auto told = life_.cause;
    if (!why.cause.empty() || !life_.failing_since || !(on_the_way || no_news)) {
        life_.cause = why.cause;
        life_.hint = why.hint;
    }
    life_.next_attempt.reset();
    if (life_.phase == Phase::absent && event == Event::opened) {
        failures_ = 0;  // plugged in: what failed before has an end
    }
    const bool changed = *phase != life_.phase;
    if (changed) {
        enter(*phase, why, now);
    }
    if (event == Event::lost) {
        plan_attempt(now);
    }
    return changed || told != life_.cause;
}

void Supervisor::enter(Phase phase, const Problem& why, Moment now) {
    if (life_.recent.size() == recent_changes) {
        life_.recent.erase(life_.recent.begin());
    }
    life_.recent.push_back({life_.phase, phase, now.wall, why.cause});
    ++life_.changes;
    life_.phase = phase;
    life_.since = now.wall;
    note_trouble(phase, now);
}

void Supervisor::note_trouble(Phase phase, Moment now) {
    if (is_well(phase)) {
        if (life_.failing_since) {
            ++life_.recoveries;
        }
        life_.failing_since.reset();
        if (!well_since_) {
            well_since_ = now.steady;
        }
    } else if (is_trouble(phase)) {
        if (!life_.failing_since) {
            life_.failing_since = now.wall;
        }
        if (well_since_ && now.steady - *well_since_ >= policy_.forgives_after) {
            failures_ = 0;
        }
        well_since_.reset();
    } else if (phase == Phase::disconnected) {
        life_.failing_since.reset();
    }
}

void Supervisor::plan_attempt(Moment now) {
    const auto wait = async::wait_after(++failures_, policy_.attempts, luck());
    next_attempt_ = now.steady + wait;
    life_.next_attempt = now.wall + wait;
}

bool Supervisor::may_reset(Moment now) {
    while (!resets_.empty() && now.steady - resets_.front() >= policy_.reset_window) {
        resets_.pop_front();
    }
    return resets_.size() < policy_.resets;
}

std::chrono::milliseconds Supervisor::reset_wait() {
    if (resets_.empty()) {
        return {};
    }
    return async::wait_after(
        static_cast<std::uint32_t>(resets_.size()),
        policy_.reset_waits,
        luck()
    );
}

void Supervisor::count_reset(Moment now) {
    resets_.push_back(now.steady);
}

double Supervisor::luck() {
    return std::uniform_real_distribution<double>(0.0, 1.0)(random_);
}

}  // namespace sweepcast::device
