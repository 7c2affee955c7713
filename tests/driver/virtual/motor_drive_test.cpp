// MotorDrive: which commands a scanner's motor obeys, and how well.
#include "driver/virtual/motor_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;

constexpr Moment start{};
constexpr SerialNumber serial{1, 2, 3};
const Persona& a1 = *find_persona("a1m8");
const Persona& a3 = *find_persona("a3m1");
const Persona& s2 = *find_persona("s2");
const Persona& c1 = *find_persona("c1");

MotorDrive drive(const Persona& persona, bool stalled = false) {
    return {persona, serial, stalled, start};
}

double speed(const MotorDrive& drive) {
    return drive.motor().rotation_hz(start + 1h);
}

TEST(SpeedAtPwm, IsOffByExemplarSoThatItHasToBeRegulated) {
    for (int i = 0; i < 200; ++i) {
        const double deviation = deviation_of(serial_from(std::to_string(i)));
        const double off = std::abs(speed_at_pwm(a3, deviation, 660) / 10.0 - 1.0);
        EXPECT_GE(off, 0.039);
        EXPECT_LE(off, 0.081);
    }
    EXPECT_GT(speed_at_pwm(a3, deviation_of(serial_from("0")), 660), 0.0);
}

TEST(SpeedAtPwm, DiffersToBothSides) {
    bool slower = false;
    bool faster = false;
    for (int i = 0; i < 20; ++i) {
        const double deviation = deviation_of(serial_from(std::to_string(i)));
        slower = slower || deviation < 0.0;
        faster = faster || deviation > 0.0;
    }
    EXPECT_TRUE(slower && faster);
}

TEST(SpeedAtPwm, RisesWithTheDutyButNotInProportion) {
    for (std::uint16_t pwm = 67; pwm < 1023; ++pwm) {
        const auto more = static_cast<std::uint16_t>(pwm + 1);
        EXPECT_GT(speed_at_pwm(a3, 0.0, more), speed_at_pwm(a3, 0.0, pwm)) << pwm;
    }
    EXPECT_DOUBLE_EQ(speed_at_pwm(a3, 0.0, 660), 10.0);
    EXPECT_EQ(speed_at_pwm(a3, 0.0, 60), 0.0) << "friction";
    EXPECT_EQ(speed_at_pwm(a3, 0.0, 0), 0.0);
    EXPECT_GT(std::abs(speed_at_pwm(a3, 0.0, 330) - 5.0), 0.2);
    EXPECT_EQ(speed_at_pwm(a3, 0.0, 65535), speed_at_pwm(a3, 0.0, 1023));
}

TEST(SpeedAtPwm, ReachesWhatTheScannerSaysItCan) {
    for (const double deviation : {-1.0, 1.0}) {
        EXPECT_GT(speed_at_pwm(a3, deviation, 1023), 13.5);
        EXPECT_LT(speed_at_pwm(a3, deviation, 300), 5.0);
    }
}

TEST(SpeedAtRpm, IsWhatWasAskedForWithinHalfAPercent) {
    for (const double deviation : {-1.0, -0.5, 0.5, 1.0}) {
        EXPECT_NEAR(speed_at_rpm(s2, deviation, 420), 7.0, 7.0 * 0.005);
    }
    EXPECT_NE(speed_at_rpm(s2, 1.0, 420), 7.0);
    EXPECT_EQ(speed_at_rpm(s2, 1.0, 0), 0.0);
}

TEST(SpeedAtRpm, StaysWithinWhatTheScannerSaysItCan) {
    EXPECT_DOUBLE_EQ(speed_at_rpm(s2, 0.0, 1), 5.0);
    EXPECT_DOUBLE_EQ(speed_at_rpm(s2, 0.0, 65535), 15.0);
}

TEST(MotorDrive, OfAnA1TurnsFromTheStartAndIsOnlySwitched) {
    auto motor = drive(a1);
    EXPECT_TRUE(motor.is_on());
    EXPECT_FALSE(motor.set_pwm(100, start)) << "it was on already";
    EXPECT_DOUBLE_EQ(speed(motor), 5.5);
    EXPECT_FALSE(motor.set_rpm(420, start));
    EXPECT_TRUE(motor.set_pwm(0, start));
    EXPECT_EQ(speed(motor), 0.0);
    EXPECT_FALSE(motor.begin_scan(start));
    EXPECT_FALSE(motor.is_on());
    EXPECT_TRUE(motor.set_pwm(1, start));
    EXPECT_FALSE(motor.reset(start));
    EXPECT_TRUE(motor.is_on());
}

TEST(MotorDrive, WithABoardObeysTheDutyAndNothingElse) {
    auto motor = drive(a3);
    EXPECT_FALSE(motor.is_on());
    EXPECT_FALSE(motor.begin_scan(start));
    EXPECT_FALSE(motor.set_rpm(600, start));
    EXPECT_TRUE(motor.set_pwm(660, start));
    EXPECT_DOUBLE_EQ(speed(motor), speed_at_pwm(a3, deviation_of(serial), 660));
    EXPECT_FALSE(motor.set_pwm(500, start));
    EXPECT_DOUBLE_EQ(speed(motor), speed_at_pwm(a3, deviation_of(serial), 500));
    EXPECT_FALSE(motor.end_scan(start));
    EXPECT_FALSE(motor.reset(start));
    EXPECT_TRUE(motor.is_on());
    EXPECT_TRUE(motor.set_pwm(0, start));
}

TEST(MotorDrive, ThatIsToldRpmObeysThemAndStartsForAScan) {
    auto motor = drive(s2);
    EXPECT_FALSE(motor.is_on());
    EXPECT_FALSE(motor.set_pwm(660, start));
    EXPECT_TRUE(motor.begin_scan(start));
    EXPECT_NEAR(speed(motor), 10.0, 0.05);
    EXPECT_FALSE(motor.set_rpm(420, start));
    EXPECT_NEAR(speed(motor), 7.0, 0.035);
    EXPECT_FALSE(motor.begin_scan(start)) << "it turns already";
    EXPECT_NEAR(speed(motor), 7.0, 0.035);
    EXPECT_FALSE(motor.end_scan(start));
    EXPECT_TRUE(motor.is_on());
    EXPECT_TRUE(motor.reset(start));
}

TEST(MotorDrive, OfAC1SpinsForAScanAndTakesNoCommands) {
    auto motor = drive(c1);
    EXPECT_FALSE(motor.set_pwm(660, start));
    EXPECT_FALSE(motor.set_rpm(600, start));
    EXPECT_FALSE(motor.is_on());
    EXPECT_TRUE(motor.begin_scan(start));
    EXPECT_FALSE(motor.set_rpm(420, start));
    EXPECT_DOUBLE_EQ(speed(motor), 10.0);
    EXPECT_TRUE(motor.end_scan(start));
}

TEST(MotorDrive, ThatIsStalledIsOnButNeverTurns) {
    for (const auto* persona : {&a1, &a3, &s2, &c1}) {
        auto motor = drive(*persona, true);
        motor.switch_on(start);
        EXPECT_TRUE(motor.is_on());
        EXPECT_EQ(speed(motor), 0.0);
        EXPECT_FALSE(motor.motor().stable_from());
    }
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
