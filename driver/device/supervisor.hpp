// Supervisor: takes what happens to a lidar and keeps the account of its life: phase, cause, times,
// counts, when to try again and how often to reset. No I/O; times come in as arguments.
#pragma once

#include "driver/async/backoff.hpp"
#include "driver/device/life.hpp"
#include "driver/device/transitions.hpp"
#include "driver/protocol/result.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>

namespace sweepcast::device {

/// How hard a lidar is tried to be brought back.
struct RecoveryPolicy {
    /// Waits between attempts to reach it.
    async::Backoff attempts{std::chrono::milliseconds(200), std::chrono::milliseconds(5000)};
    /// Once it has been well for so long, the next failure is the first again.
    std::chrono::milliseconds forgives_after{10'000};
    /// Resets out of protection stop that it gets by itself within `reset_window`.
    std::size_t resets{3};
    std::chrono::milliseconds reset_window{std::chrono::minutes(10)};
    /// Waits before the second such reset and those after it.
    async::Backoff reset_waits{std::chrono::milliseconds(1000), std::chrono::milliseconds(10'000)};
    /// Times that a stalled scan is started again before the port is closed and opened.
    std::uint32_t restarts{2};
};

/// Both clocks, read together.
struct Moment {
    std::chrono::steady_clock::time_point steady{};
    std::chrono::system_clock::time_point wall{};
    [[nodiscard]] static Moment now() {
        return {std::chrono::steady_clock::now(), std::chrono::system_clock::now()};
    }
};

class Supervisor {
public:
    /// Writes into `life`, which outlives it. `seed` is of the waits' jitter.
    Supervisor(Life& life, RecoveryPolicy policy, std::uint64_t seed);

    /// Takes what happened, for the reason `why`. Returns whether phase or cause changed.
    /// Throws std::logic_error if it must not happen in this phase: a broken invariant.
    bool on(Event event, const Problem& why, Moment now);

    /// When to try to reach the lidar again, after Event::lost. Longer from failure to failure,
    /// until it has been well for a while.
    [[nodiscard]] std::chrono::steady_clock::time_point next_attempt() const {
        return next_attempt_;
    }

    /// Whether one of the resets that a lidar in protection stop gets by itself is left.
    [[nodiscard]] bool may_reset(Moment now);
    /// How long to wait before that reset.
    [[nodiscard]] std::chrono::milliseconds reset_wait();
    /// The reset is made now.
    void count_reset(Moment now);
    /// Its user has seen to it: all resets are there again.
    void refill_resets() { resets_.clear(); }
    [[nodiscard]] std::size_t resets_taken() const { return resets_.size(); }

    [[nodiscard]] const RecoveryPolicy& policy() const { return policy_; }

private:
    void enter(Phase phase, const Problem& why, Moment now);
    void note_trouble(Phase phase, Moment now);
    void plan_attempt(Moment now);
    [[nodiscard]] double luck();

    Life& life_;
    RecoveryPolicy policy_;
    std::mt19937_64 random_;
    std::uint32_t failures_{};
    std::chrono::steady_clock::time_point next_attempt_{};
    /// Since when it has been well; unset: it is not.
    std::optional<std::chrono::steady_clock::time_point> well_since_;
    std::deque<std::chrono::steady_clock::time_point> resets_;
};

}  // namespace sweepcast::device
