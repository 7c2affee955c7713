// Emulator: its states, the motor, the line. What its measurements say is in
// emulator_scan_test.cpp.
#include "driver/virtual/random.hpp"
#include "tests/driver/virtual/fake_host.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;
using protocol::Command;
using testing::ElementsAre;
using testing::IsEmpty;

const Bytes health_good{0xA5, 0x5A, 3, 0, 0, 0, 0x06, 0, 0, 0};
const Bytes normal_descriptor{0xA5, 0x5A, 5, 0, 0, 0x40, 0x81};
const Bytes express_descriptor{0xA5, 0x5A, 0x54, 0, 0, 0x40, 0x82};
const Bytes express_mode{1, 0, 0, 0, 0};
const Bytes motor_at_660{0x94, 0x02};
const Bytes motor_at_0{0, 0};

bool ends_with(const Bytes& bytes, const Bytes& end) {
    return bytes.size() >= end.size() && std::equal(end.rbegin(), end.rend(), bytes.rbegin());
}

TEST(Emulator, SaysNothingUnasked) {
    FakeHost host;
    host.run(3s);
    EXPECT_THAT(host.received(), IsEmpty());
    EXPECT_EQ(host.emulator.next_due(), std::nullopt);
}

TEST(Emulator, SendsTheDescriptorAtOnceAndMeasurementsWhenTheRotationIsStable) {
    FakeHost host;
    host.send(Command::scan);
    host.run(999ms);
    EXPECT_EQ(host.received(), normal_descriptor);
    host.run(50ms);
    EXPECT_GT(host.measurements().size(), 400U);
}

TEST(Emulator, MeasuresAtOnceWhenForced) {
    FakeHost host;
    host.send(Command::force_scan);
    host.run(50ms);
    EXPECT_GT(host.measurements().size(), 400U);
}

TEST(Emulator, MeasuresWithTheMotorAtRestOnlyWhenForced) {
    FakeHost host;
    host.send(Command::set_motor_pwm, motor_at_0);
    host.run(5s);
    host.send(Command::scan);
    host.run(5s);
    EXPECT_EQ(host.received(), normal_descriptor);
    host.send(Command::force_scan);
    host.run(50ms);
    EXPECT_GT(host.measurements().size(), 400U);
}

TEST(Emulator, BeginsAWaitingScanWhenTheMotorIsSwitchedOn) {
    FakeHost host;
    host.send(Command::set_motor_pwm, motor_at_0);
    host.run(5s);
    host.send(Command::express_scan, express_mode);
    host.run(5s);
    EXPECT_EQ(host.received(), express_descriptor);
    EXPECT_EQ(host.emulator.next_due(), std::nullopt);
    host.send(Command::set_motor_pwm, motor_at_660);
    host.run(1100ms);
    EXPECT_GT(host.measurements().size(), 800U);
}

TEST(Emulator, PausesAScanWhileTheMotorIsOffAndGoesOnWithARestart) {
    FakeHost host;
    host.spin_up();
    host.send(Command::express_scan, express_mode);
    host.run(500ms);
    host.send(Command::set_motor_pwm, motor_at_0);
    host.run(100ms);
    host.received();
    host.run(3s);
    EXPECT_THAT(host.received(), IsEmpty());
    host.send(Command::set_motor_pwm, motor_at_660);
    host.run(1100ms);
    const auto capsules = host.received();
    ASSERT_GT(capsules.size(), 84U * 2U);
    EXPECT_EQ(capsules[3] & 0x80, 0x80) << "the first capsule has the S bit";
    EXPECT_EQ(capsules[84 + 3] & 0x80, 0) << "the second has not";
}

TEST(Emulator, ObeysTheMotorWithoutEndingAScan) {
    FakeHost host;
    host.spin_up();
    host.send(Command::scan);
    host.run(100ms);
    host.received();
    host.send(Command::set_motor_pwm, motor_at_660);
    host.send(Command::motor_rpm, {0x58, 0x02});
    host.run(100ms);
    EXPECT_GT(host.measurements().size(), 900U);
    EXPECT_THAT(host.events, ElementsAre(Occurrence::scan_started)) << "the motor was on already";
}

class AnyRequest : public testing::TestWithParam<Command> {};

TEST_P(AnyRequest, EndsAScan) {
    FakeHost host;
    host.spin_up();
    host.send(Command::express_scan, express_mode);
    host.run(1s);
    host.received();
    host.send(GetParam());
    EXPECT_THAT(host.events, testing::Contains(Occurrence::scan_stopped));
    host.run(100ms);
    EXPECT_LE(host.measurements().size(), 64U) << "what was on its way already";
    host.run(1s);
    EXPECT_THAT(host.measurements(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Requests,
    AnyRequest,
    testing::Values(
        Command::stop,
        Command::reset,
        Command::get_info,
        Command::get_health,
        Command::get_lidar_conf,
        Command::get_acc_board_flag,
        Command{0x31}
    )
);

TEST(Emulator, ServesTheRequestThatEndsAScan) {
    FakeHost host;
    host.spin_up();
    host.send(Command::scan);
    host.run(100ms);
    host.send(Command::get_health);
    host.run(50ms);
    EXPECT_TRUE(ends_with(host.received(), health_good));
}

TEST(Emulator, BeginsAnewWhenAskedToScanWhileScanning) {
    FakeHost host;
    host.spin_up();
    host.send(Command::scan);
    host.run(100ms);
    host.transmitted.clear();
    host.send(Command::express_scan, express_mode);
    host.run(100ms);
    ASSERT_GE(host.transmitted.size(), 2U);
    const auto& descriptor =
        host.transmitted[host.transmitted[0].payload == Payload::answer ? 0 : 1];
    EXPECT_EQ(Bytes(descriptor.bytes.begin(), descriptor.bytes.begin() + 1), Bytes{0xA5});
    EXPECT_THAT(
        host.events,
        ElementsAre(Occurrence::scan_started, Occurrence::scan_stopped, Occurrence::scan_started)
    );
}

TEST(Emulator, AnswersOneRequestAtATime) {
    FakeHost host;
    host.send(Bytes{0xA5, 0x52, 0xA5, 0x52, 0xA5, 0x52});
    host.run(50ms);
    EXPECT_EQ(host.received(), health_good);
    host.send(Command::get_health);
    host.run(50ms);
    EXPECT_EQ(host.received(), health_good);
}

TEST(Emulator, AnswersARequestThatFollowsAStop) {
    FakeHost host;
    host.send(Bytes{0xA5, 0x25, 0xA5, 0x52});
    host.run(50ms);
    EXPECT_EQ(host.received(), health_good);
}

TEST(Emulator, ForgetsARequestThatIsNotCompletedInTime) {
    FakeHost host;
    host.send(Bytes{0xA5});
    host.run(6s, 100ms);
    host.send(Bytes{0x52});
    host.run(50ms);
    EXPECT_THAT(host.received(), IsEmpty());
}

TEST(Emulator, PrintsItsBootTextAfterAReset) {
    FakeHost host;
    host.send(Command::reset);
    host.run(9ms);
    EXPECT_THAT(host.received(), IsEmpty());
    host.run(11ms);
    const auto text = host.received();
    EXPECT_EQ(std::string(text.begin(), text.end()), host.persona.boot_text);
    EXPECT_THAT(host.events, ElementsAre(Occurrence::reset));
}

TEST(Emulator, IsDeafWhileItBoots) {
    FakeHost host;
    host.send(Command::reset);
    host.run(5ms);
    host.send(Command::get_health);
    host.run(50ms);
    EXPECT_EQ(host.received().size(), host.persona.boot_text.size());
    host.send(Command::get_health);
    host.run(50ms);
    EXPECT_EQ(host.received(), health_good);
}

TEST(Emulator, LeavesTheMotorAloneInAReset) {
    FakeHost host;
    host.spin_up();
    host.send(Command::reset);
    host.run(50ms);
    host.received();
    host.send(Command::scan);
    host.run(20ms);
    EXPECT_THAT(host.measurements(), testing::Not(IsEmpty())) << "it has not stopped turning";
}

TEST(Emulator, InProtectionStopOnlyReportsUntilReset) {
    FakeHost host;
    host.spin_up();
    host.send(Command::scan);
    host.run(100ms);
    host.emulator.enter_protection_stop(0x1234, host.now);
    host.run(100ms);
    host.received();
    for (const auto refused : {Command::scan, Command::force_scan, Command::stop}) {
        host.send(refused);
    }
    host.send(Command::express_scan, express_mode);
    host.run(1s);
    EXPECT_THAT(host.received(), IsEmpty());
    host.send(Command::get_health);
    host.run(50ms);
    EXPECT_EQ(host.received(), (Bytes{0xA5, 0x5A, 3, 0, 0, 0, 0x06, 2, 0x34, 0x12}));
    host.send(Command::reset);
    host.run(50ms);
    host.received();
    host.send(Command::get_health);
    host.run(50ms);
    EXPECT_EQ(host.received(), health_good);
}

TEST(Emulator, ReportsMotorSwitching) {
    FakeHost host;
    host.send(Command::set_motor_pwm, motor_at_0);
    host.send(Command::set_motor_pwm, motor_at_0);
    host.send(Command::set_motor_pwm, motor_at_660);
    host.send(Command::set_motor_pwm, {});
    EXPECT_THAT(host.events, ElementsAre(Occurrence::motor_off, Occurrence::motor_on));
}

TEST(Emulator, IsNeverFasterThanItsLine) {
    FakeHost host;
    host.spin_up();
    host.send(Command::express_scan, express_mode);
    for (int i = 0; i < 300; ++i) {
        host.run(10ms);
        EXPECT_LE(host.received().size(), 116U);
    }
}

TEST(Emulator, TellsWhenItIsDueNext) {
    FakeHost host;
    host.send(Command::scan);
    EXPECT_EQ(host.emulator.next_due(), host.now + 500us + 86806ns) << "a byte of the descriptor";
    host.run(10ms);
    EXPECT_EQ(host.emulator.next_due(), host.now + 990ms) << "the rotation is stable";
    host.run(990ms);
    EXPECT_EQ(host.emulator.next_due(), host.now + 750us) << "a sample is ready";
}

TEST(Emulator, LosesNothingWhenTheProcessIsHeldUpForAMoment) {
    FakeHost steady;
    FakeHost held_up;
    for (auto* host : {&steady, &held_up}) {
        host->spin_up();
        host->send(Command::express_scan, express_mode);
    }
    steady.run(3s, 1ms);
    held_up.run(3s, 250ms);
    EXPECT_EQ(steady.received(), held_up.received());
    EXPECT_EQ(held_up.emulator.overrun_bytes(), 0U);
}

TEST(Emulator, DoesNotCatchUpAfterALongHalt) {
    FakeHost host;
    host.spin_up();
    host.send(Command::express_scan, express_mode);
    host.run(100ms);
    host.received();
    host.run(24h, 24h);
    EXPECT_LE(host.received().size(), 84U);
    host.run(100ms);
    const auto capsules = host.received();
    ASSERT_GT(capsules.size(), 84U * 5U);
    EXPECT_EQ(capsules[3] & 0x80, 0x80) << "the angle reference was restarted";
}

TEST(Emulator, SurvivesAnyBytes) {
    FakeHost host;
    Random random(7);
    for (int i = 0; i < 20'000; ++i) {
        // Mostly requests that are nearly right: random bytes alone never get past the start byte.
        const auto choice = random.next();
        Bytes bytes{0xA5, static_cast<std::uint8_t>(choice)};
        if (choice % 3 == 0) {
            Bytes payload(choice % 9, static_cast<std::uint8_t>(choice >> 8U));
            bytes = protocol::encode(
                {Command{static_cast<std::uint8_t>(choice | 0x80U)}, std::move(payload)}
            );
        } else if (choice % 7 == 0) {
            bytes.assign(choice % 64, static_cast<std::uint8_t>(choice >> 16U));
        }
        host.send(bytes);
        host.run(std::chrono::microseconds(choice % 3000));
        host.received();
    }
    host.run(10s);
    host.send(Bytes(300, 0));  // whatever it still waits for
    host.send(Command::stop);
    host.run(100ms);
    host.received();
    host.send(Command::get_health);
    host.run(100ms);
    EXPECT_EQ(host.received(), health_good);
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
