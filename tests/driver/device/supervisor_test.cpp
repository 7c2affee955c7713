// Supervisor: the account of a lidar's life, at times that the tests make up.
#include "driver/device/supervisor.hpp"

#include "driver/device/error.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace sweepcast::device {
namespace {

using namespace std::chrono_literals;

class SupervisorTest : public testing::Test {
protected:
    bool on(Event event, const std::string& cause = "") {
        return supervisor.on(event, {{}, cause, cause.empty() ? "" : "mend it"}, now);
    }

    void pass(std::chrono::milliseconds time) {
        now.steady += time;
        now.wall += time;
    }

    void begin_scanning() {
        on(Event::attempt);
        on(Event::opened);
        on(Event::start);
        on(Event::samples);
    }

    /// Fails once more, and gives the wait until the next attempt.
    std::chrono::steady_clock::duration fail() {
        on(Event::lost, "no answer");
        return supervisor.next_attempt() - now.steady;
    }

    Life life;
    Supervisor supervisor{life, {.attempts = {200ms, 1000ms}, .resets = 2}, 1};
    Moment now{
        std::chrono::steady_clock::time_point(1h),
        std::chrono::system_clock::time_point(9h)};
};

TEST_F(SupervisorTest, KeepsPhaseTimeCauseAndCount) {
    on(Event::attempt);
    pass(5s);
    EXPECT_TRUE(on(Event::lost, "no answer"));
    EXPECT_EQ(life.phase, Phase::backing_off);
    EXPECT_EQ(life.since, now.wall);
    EXPECT_EQ(life.cause, "no answer");
    EXPECT_EQ(life.hint, "mend it");
    EXPECT_EQ(life.changes, 2U);
    ASSERT_EQ(life.recent.size(), 2U);
    EXPECT_EQ(
        life.recent[1],
        (PhaseChange{Phase::opening, Phase::backing_off, now.wall, "no answer"})
    );
}

TEST_F(SupervisorTest, KeepsTheLastChangesOnly) {
    begin_scanning();
    for (int i = 0; i < 30; ++i) {
        on(Event::stop);
        on(Event::start);
        on(Event::samples);
    }
    EXPECT_EQ(life.changes, 94U);
    EXPECT_EQ(life.recent.size(), recent_changes);
    EXPECT_EQ(life.recent.back().to, Phase::scanning);
}

TEST_F(SupervisorTest, WhatIsNotInTheTableIsABrokenInvariant) {
    EXPECT_THROW(on(Event::samples), std::logic_error);
    EXPECT_EQ(life.phase, Phase::disconnected);
}

TEST_F(SupervisorTest, TroubleLastsThroughAllAttemptsUntilItIsWell) {
    on(Event::attempt);
    pass(1s);
    on(Event::lost, "no answer");
    const auto began = now.wall;
    pass(1s);
    on(Event::attempt);
    on(Event::opened);
    EXPECT_EQ(life.failing_since, began);
    EXPECT_EQ(life.cause, "no answer") << "why it is being tried again";
    EXPECT_EQ(life.recoveries, 0U);
    on(Event::rest);
    EXPECT_EQ(life.failing_since, std::nullopt);
    EXPECT_EQ(life.cause, "");
    EXPECT_EQ(life.recoveries, 1U);
}

TEST_F(SupervisorTest, AStopByTheUserIsNoTrouble) {
    begin_scanning();
    on(Event::stop);
    on(Event::rest);
    on(Event::start);
    on(Event::samples);
    EXPECT_EQ(life.recoveries, 0U);
}

TEST_F(SupervisorTest, TheNextAttemptIsToldWhileBackingOffOnly) {
    on(Event::attempt);
    const auto wait = fail();
    EXPECT_EQ(life.next_attempt, now.wall + std::chrono::floor<std::chrono::milliseconds>(wait));
    on(Event::attempt);
    EXPECT_EQ(life.next_attempt, std::nullopt);
}

TEST_F(SupervisorTest, WaitsLongerFromFailureToFailureUpToTheLongest) {
    on(Event::attempt);
    for (const auto longest : {200ms, 400ms, 800ms, 1000ms, 1000ms}) {
        const auto wait = fail();
        EXPECT_LE(wait, longest);
        EXPECT_GE(wait, longest / 2);
        on(Event::attempt);
    }
}

TEST_F(SupervisorTest, ForgivesWhatFailedOnceItHasBeenWellForAWhile) {
    on(Event::attempt);
    for (int i = 0; i < 5; ++i) {
        fail();
        on(Event::attempt);
    }
    on(Event::opened);
    on(Event::start);
    on(Event::samples);
    pass(9s);
    EXPECT_GT(fail(), 400ms) << "well for too short a time";
    begin_scanning();
    pass(10s);
    EXPECT_LE(fail(), 200ms);
}

TEST_F(SupervisorTest, ForgivesWhatFailedWhenThePortHasComeBack) {
    on(Event::attempt);
    for (int i = 0; i < 5; ++i) {
        fail();
        on(Event::attempt);
    }
    on(Event::no_port, "no such port");
    on(Event::opened);
    EXPECT_LE(fail(), 200ms);
}

TEST_F(SupervisorTest, ResetsAreRationed) {
    supervisor.count_reset(now);
    pass(1min);
    EXPECT_TRUE(supervisor.may_reset(now));
    EXPECT_TRUE(supervisor.may_reset(now)) << "only those that are made count";
    supervisor.count_reset(now);
    EXPECT_FALSE(supervisor.may_reset(now));
    pass(9min);
    EXPECT_TRUE(supervisor.may_reset(now)) << "the first is ten minutes ago";
    supervisor.count_reset(now);
    EXPECT_FALSE(supervisor.may_reset(now));
    supervisor.refill_resets();
    EXPECT_TRUE(supervisor.may_reset(now));
}

TEST_F(SupervisorTest, TheFirstResetIsAtOnceAndTheNextIsNot) {
    EXPECT_EQ(supervisor.reset_wait(), 0ms);
    supervisor.count_reset(now);
    EXPECT_GE(supervisor.reset_wait(), 500ms);
}

}  // namespace
}  // namespace sweepcast::device
