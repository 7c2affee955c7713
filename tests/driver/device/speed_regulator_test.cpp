// SpeedRegulator and Speedometer: closed loops against motors that are described by a function.
#include "driver/device/speed_regulator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace sweepcast::device {
namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;
using testing::HasSubstr;

MotorTraits board() {
    return {
        .control = protocol::MotorControl::accessory_board,
        .desired = {600, 660},
        .min_rpm = 300,
        .max_rpm = 900};
}

microseconds turn_at(double hz) {
    return microseconds(std::llround(1e6 / hz));
}

/// A motor that follows its duty with a time constant, as all with inertia do.
class Motor {
public:
    Motor(std::function<double(double)> speed_of_duty, double time_constant_s)
        : speed_of_duty_(std::move(speed_of_duty))
        , time_constant_s_(time_constant_s) {}

    microseconds turn(std::uint16_t duty) {
        const double period_s = 1.0 / hz_;
        const double share = 1.0 - std::exp(-period_s / time_constant_s_);
        hz_ += (speed_of_duty_(duty) - hz_) * share;
        return turn_at(hz_);
    }
    [[nodiscard]] double hz() const { return hz_; }

private:
    std::function<double(double)> speed_of_duty_;
    double time_constant_s_;
    double hz_{3.0};
};

/// Turns until the speed is met and steady, at most `most`; gives the turns it took.
int turns_to_settle(SpeedRegulator& regulator, Motor& motor, int most) {
    int met = 0;
    for (int turn = 1; turn <= most; ++turn) {
        regulator.observe(motor.turn(regulator.setting()));
        met = regulator.rotation().settled ? met + 1 : 0;
        if (met >= 20) {
            return turn - 20;
        }
    }
    return most;
}

TEST(SpeedometerTest, IsTheMeanOfTheLastRevolutions) {
    Speedometer speed;
    EXPECT_EQ(speed.hz(), 0.0);
    speed.add(100ms);
    EXPECT_DOUBLE_EQ(speed.hz(), 10.0);
    speed.add(300ms);
    EXPECT_DOUBLE_EQ(speed.hz(), 5.0);
    for (int i = 0; i < 6; ++i) {
        speed.add(125ms);
    }
    EXPECT_DOUBLE_EQ(speed.hz(), 8.0);
}

TEST(SpeedometerTest, DoesNotCountRevolutionsWithoutATime) {
    Speedometer speed;
    speed.add(0us);
    speed.add(-5us);
    EXPECT_EQ(speed.hz(), 0.0);
}

TEST(SpeedometerTest, IsSteadyOnceItNoLongerChanges) {
    Speedometer speed;
    for (int i = 0; i < 5; ++i) {
        speed.add(100ms);
        EXPECT_FALSE(speed.steady());
    }
    speed.add(100ms);
    EXPECT_TRUE(speed.steady());
    for (int i = 1; i <= 6; ++i) {
        speed.add(100ms + i * 500us);
    }
    EXPECT_FALSE(speed.steady()) << "half a percent slower with every turn";
}

TEST(SpeedIsMetTest, WithinTwoPercent) {
    EXPECT_TRUE(speed_is_met(7.13, 7.0));
    EXPECT_TRUE(speed_is_met(6.87, 7.0));
    EXPECT_FALSE(speed_is_met(7.15, 7.0));
    EXPECT_FALSE(speed_is_met(0.0, 7.0));
    EXPECT_FALSE(speed_is_met(7.0, 0.0));
}

TEST(SpeedRegulatorTest, BeginsWithTheDutyThatTheLidarNames) {
    SpeedRegulator regulator(board());
    EXPECT_EQ(regulator.setting(), 660);
    EXPECT_EQ(regulator.rotation().wanted_hz, 10.0);
    regulator.want(5.0);
    EXPECT_EQ(regulator.setting(), 330);
}

struct MotorCase {
    const char* name;
    std::function<double(double)> speed_of_duty;
    double time_constant_s;
};
void PrintTo(const MotorCase& motor, std::ostream* out) {
    *out << motor.name;
}

class AnyMotor : public testing::TestWithParam<MotorCase> {};

TEST_P(AnyMotor, IsBroughtToTheWantedSpeedAndKeptThere) {
    for (const double wanted : {5.0, 7.0, 10.0, 13.0}) {
        Motor motor(GetParam().speed_of_duty, GetParam().time_constant_s);
        SpeedRegulator regulator(board());
        regulator.want(wanted);
        EXPECT_LT(turns_to_settle(regulator, motor, 400), 200) << wanted << " Hz";
        EXPECT_NEAR(motor.hz(), wanted, 0.02 * wanted);
        EXPECT_EQ(regulator.rotation().warning, "");
    }
}

INSTANTIATE_TEST_SUITE_P(
    Motors,
    AnyMotor,
    testing::Values(
        MotorCase{"as_named", [](double duty) { return duty / 66.0; }, 0.3},
        MotorCase{"eight_percent_slow", [](double duty) { return duty / 66.0 * 0.92; }, 0.5},
        MotorCase{"sluggish", [](double duty) { return duty / 66.0 * 1.08; }, 2.0},
        MotorCase{
            "with_friction",
            [](double duty) { return std::max(1.0, (duty - 150.0) / 52.0); },
            0.5},
        MotorCase{"bent", [](double duty) { return 0.42 * std::sqrt(duty + 20.0); }, 0.5}
    ),
    [](const auto& tested) { return std::string(tested.param.name); }
);

TEST(SpeedRegulatorTest, FollowsANewWish) {
    Motor motor([](double duty) { return duty / 66.0 * 0.92; }, 0.5);
    SpeedRegulator regulator(board());
    (void)turns_to_settle(regulator, motor, 400);
    regulator.want(7.0);
    EXPECT_FALSE(regulator.rotation().settled);
    (void)turns_to_settle(regulator, motor, 400);
    EXPECT_NEAR(motor.hz(), 7.0, 0.14);
}

TEST(SpeedRegulatorTest, CorrectsADriftOfTheMotor) {
    double factor = 1.0;
    Motor motor([&factor](double duty) { return duty / 66.0 * factor; }, 0.5);
    SpeedRegulator regulator(board());
    (void)turns_to_settle(regulator, motor, 400);
    factor = 0.9;
    for (int turn = 0; turn < 100; ++turn) {
        regulator.observe(motor.turn(regulator.setting()));
    }
    EXPECT_NEAR(motor.hz(), 10.0, 0.1);
}

TEST(SpeedRegulatorTest, SaysThatFullDutyIsNotEnough) {
    Motor motor([](double duty) { return duty / 120.0; }, 0.5);
    SpeedRegulator regulator(board());
    regulator.want(14.0);
    (void)turns_to_settle(regulator, motor, 100);
    EXPECT_EQ(regulator.setting(), full_duty);
    EXPECT_FALSE(regulator.rotation().settled);
    EXPECT_THAT(regulator.rotation().warning, HasSubstr("full duty"));
}

TEST(SpeedRegulatorTest, IsNotSettledWhileThePassingSpeedIsTheWantedOne) {
    SpeedRegulator regulator(board());
    regulator.want(7.0);
    for (double hz = 10.0; hz > 6.0; hz -= 0.05) {
        regulator.observe(turn_at(hz));
        EXPECT_FALSE(regulator.rotation().settled) << hz;
    }
}

TEST(SpeedRegulatorTest, DoesNotWarnWhileItCorrects) {
    double factor = 1.0;
    Motor motor([&factor](double duty) { return duty / 66.0 * factor; }, 0.5);
    SpeedRegulator regulator(board());
    (void)turns_to_settle(regulator, motor, 400);
    factor = 0.8;
    for (int turn = 0; turn < 100; ++turn) {
        regulator.observe(motor.turn(regulator.setting()));
        EXPECT_EQ(regulator.rotation().warning, "") << "turn " << turn;
    }
}

TEST(SpeedRegulatorTest, DoesNotWarnOfAStoppedMotor) {
    SpeedRegulator regulator(board());
    for (int turn = 0; turn < 100; ++turn) {
        regulator.observe(turn_at(10.0));
    }
    regulator.stopped();
    EXPECT_EQ(regulator.rotation().warning, "");
}

TEST(SpeedRegulatorTest, TellsALidarThatRegulatesItselfTheRpm) {
    auto traits = board();
    traits.control = protocol::MotorControl::rpm;
    SpeedRegulator regulator(traits);
    EXPECT_EQ(regulator.setting(), 600);
    regulator.want(7.0);
    EXPECT_EQ(regulator.setting(), 420);
    for (int turn = 0; turn < 10; ++turn) {
        regulator.observe(turn_at(7.05));
    }
    EXPECT_EQ(regulator.setting(), 420) << "its own regulation is not interfered with";
    EXPECT_TRUE(regulator.rotation().settled);
}

TEST(SpeedRegulatorTest, SaysThatALidarDoesNotTurnAsTold) {
    auto traits = board();
    traits.control = protocol::MotorControl::rpm;
    SpeedRegulator regulator(traits);
    regulator.want(7.0);
    for (int turn = 0; turn < 100; ++turn) {
        regulator.observe(turn_at(5.0));
    }
    EXPECT_THAT(regulator.rotation().warning, HasSubstr("7.0 Hz but turns at 5.0"));
}

TEST(SpeedRegulatorTest, RepeatsNoWarningBecauseOfJitter) {
    auto traits = board();
    traits.control = protocol::MotorControl::rpm;
    SpeedRegulator regulator(traits);
    regulator.want(7.0);
    int told = 0;
    std::string before;
    for (int turn = 0; turn < 400; ++turn) {
        regulator.observe(turn_at(turn % 7 == 0 ? 5.1 : 5.045));
        const auto warning = regulator.rotation().warning;
        told += warning != before ? 1 : 0;
        before = warning;
    }
    EXPECT_EQ(told, 1);
    EXPECT_NE(before, "");
}

TEST(SpeedRegulatorTest, WarnsAnewWhenTheSpeedIsAnotherWrongOne) {
    auto traits = board();
    traits.control = protocol::MotorControl::rpm;
    SpeedRegulator regulator(traits);
    regulator.want(7.0);
    for (int turn = 0; turn < 100; ++turn) {
        regulator.observe(turn_at(5.0));
    }
    for (int turn = 0; turn < 20; ++turn) {
        regulator.observe(turn_at(6.0));
    }
    EXPECT_THAT(regulator.rotation().warning, HasSubstr("turns at 6.0"));
    for (int turn = 0; turn < 20; ++turn) {
        regulator.observe(turn_at(7.0));
    }
    EXPECT_EQ(regulator.rotation().warning, "");
}

class FixedSpeed : public testing::TestWithParam<protocol::MotorControl> {};

TEST_P(FixedSpeed, CannotBeWantedOtherwise) {
    SpeedRegulator regulator({.control = GetParam()});
    regulator.observe(turn_at(5.5));
    EXPECT_EQ(regulator.rotation().control, SpeedControl::fixed);
    EXPECT_EQ(regulator.rotation().warning, "");
    EXPECT_NEAR(regulator.rotation().measured_hz, 5.5, 1e-3);
    regulator.want(7.0);
    EXPECT_THAT(regulator.rotation().warning, HasSubstr("cannot be changed"));
    EXPECT_EQ(regulator.setting(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Motors,
    FixedSpeed,
    testing::Values(protocol::MotorControl::modem_line, protocol::MotorControl::self)
);

TEST(SpeedRegulatorTest, SaysThatAWishIsBeyondTheRange) {
    SpeedRegulator regulator(board());
    regulator.want(20.0);
    EXPECT_THAT(regulator.rotation().warning, HasSubstr("beyond the 5.0 to 15.0 Hz"));
    regulator.want(15.0);
    EXPECT_EQ(regulator.rotation().warning, "");
}

TEST(SpeedRegulatorTest, ForgetsTheSpeedOfAStoppedMotor) {
    SpeedRegulator regulator(board());
    regulator.observe(turn_at(10.0));
    regulator.stopped();
    EXPECT_EQ(regulator.rotation().measured_hz, 0.0);
    EXPECT_EQ(regulator.rotation().wanted_hz, 10.0);
}

}  // namespace
}  // namespace sweepcast::device
