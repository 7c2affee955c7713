// Motor: speeds, angles and when the rotation counts as stable.
#include "driver/virtual/motor.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;

constexpr MotorTraits traits{
    .control = protocol::MotorControl::rpm,
    .rotation_hz = 5.0,
    .spin_up = 1000ms,
    .coast_down = 2000ms,
    .ripple = 0.005};
constexpr Moment start{};

Motor running() {
    Motor motor(traits, start);
    motor.turn_at(5.0, start);
    return motor;
}

TEST(Motor, RestsUntilItIsSwitchedOn) {
    const Motor motor(traits, start);
    EXPECT_FALSE(motor.is_on());
    EXPECT_EQ(motor.turns(start + 10s), 0.0);
    EXPECT_EQ(motor.rotation_hz(start + 10s), 0.0);
    EXPECT_FALSE(motor.stable_from());
    EXPECT_FALSE(motor.is_stable(start + 10s));
}

TEST(Motor, IsStableOnceItHasSpunUp) {
    const auto motor = running();
    EXPECT_EQ(motor.stable_from(), start + 1s);
    EXPECT_FALSE(motor.is_stable(start + 999ms));
    EXPECT_TRUE(motor.is_stable(start + 1s));
    EXPECT_DOUBLE_EQ(motor.rotation_hz(start + 500ms), 2.5);
    EXPECT_DOUBLE_EQ(motor.rotation_hz(start + 1s), 5.0);
    EXPECT_DOUBLE_EQ(motor.rotation_hz(start + 1h), 5.0);
}

TEST(Motor, MakesAsManyTurnsAsItsSpeedSays) {
    const auto motor = running();
    const double ripple_turns = 0.005;
    EXPECT_NEAR(motor.turns(start + 1s), 2.5, ripple_turns);
    EXPECT_NEAR(motor.turns(start + 11s), 52.5, ripple_turns);
    EXPECT_NEAR(motor.turns(start + 3601s), 18'002.5, ripple_turns);
}

TEST(Motor, WandersRoundItsSpeedByNoMoreThanTheRipple) {
    const auto motor = running();
    double slowest = 10.0;
    double fastest = 0.0;
    for (auto t = start + 1s; t < start + 5s; t += 1ms) {
        const double hz = (motor.turns(t + 1ms) - motor.turns(t)) * 1000.0;
        slowest = std::min(slowest, hz);
        fastest = std::max(fastest, hz);
    }
    EXPECT_NEAR(slowest, 4.975, 1e-4);
    EXPECT_NEAR(fastest, 5.025, 1e-4);
}

TEST(Motor, CoastsDownAndRests) {
    auto motor = running();
    motor.turn_at(0.0, start + 10s);
    EXPECT_FALSE(motor.is_stable(start + 10s));
    EXPECT_DOUBLE_EQ(motor.rotation_hz(start + 11s), 2.5);
    EXPECT_DOUBLE_EQ(motor.rotation_hz(start + 12s), 0.0);
    EXPECT_EQ(motor.turns(start + 12s), motor.turns(start + 20s));
}

TEST(Motor, NeverJumpsAtACommand) {
    auto motor = running();
    for (auto t = start + 100ms; t < start + 6s; t += 370ms) {
        const double before = motor.turns(t);
        motor.turn_at(motor.is_on() ? 0.0 : 5.0, t);
        EXPECT_NEAR(motor.turns(t), before, 1e-9);
    }
}

TEST(Motor, NeverTurnsBack) {
    auto motor = running();
    double last = 0.0;
    for (auto t = start; t < start + 6s; t += 1ms) {
        if (t == start + 3s) {
            motor.turn_at(0.0, t);
        }
        EXPECT_GE(motor.turns(t), last);
        last = motor.turns(t);
    }
}

TEST(Motor, IsStableSoonerIfItWasStillTurning) {
    auto motor = running();
    motor.turn_at(0.0, start + 10s);
    motor.turn_at(5.0, start + 11s);  // half the speed is left
    EXPECT_EQ(motor.stable_from(), start + 11'500ms);
}

TEST(Motor, TakesNoNoticeOfACommandThatChangesNothing) {
    auto motor = running();
    EXPECT_FALSE(motor.turn_at(5.0, start + 500ms));
    EXPECT_EQ(motor.stable_from(), start + 1s);
    EXPECT_TRUE(motor.turn_at(0.0, start + 600ms));
}

TEST(Motor, GoesToAnotherSpeedWithInertiaAndStaysStable) {
    auto motor = running();
    motor.turn_at(7.0, start + 10s);
    EXPECT_TRUE(motor.is_stable(start + 10s));
    EXPECT_DOUBLE_EQ(motor.rotation_hz(start + 10'200ms), 6.0);
    EXPECT_DOUBLE_EQ(motor.rotation_hz(start + 10'400ms), 7.0);
    motor.turn_at(2.0, start + 20s);
    EXPECT_TRUE(motor.is_stable(start + 20s));
    EXPECT_DOUBLE_EQ(motor.rotation_hz(start + 21s), 4.5);
    EXPECT_DOUBLE_EQ(motor.rotation_hz(start + 30s), 2.0);
}

TEST(Motor, IsNotStableSoonerForAnotherSpeedInMidSpinUp) {
    auto motor = running();
    motor.turn_at(10.0, start + 500ms);
    EXPECT_EQ(motor.stable_from(), start + 2s);
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
