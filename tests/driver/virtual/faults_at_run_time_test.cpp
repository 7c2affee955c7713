// Faults that begin and end while the scanner runs, and what happens to it once.
#include "driver/protocol/decode.hpp"
#include "driver/protocol/wire.hpp"
#include "driver/virtual/emulator.hpp"
#include "tests/driver/virtual/fake_host.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;
using protocol::Command;
using protocol::HealthStatus;
using testing::Contains;
using testing::IsEmpty;

const Bytes health_good{0xA5, 0x5A, 3, 0, 0, 0, 0x06, 0, 0, 0};
const Bytes scan_descriptor{0xA5, 0x5A, 5, 0, 0, 0x40, 0x81};

Bytes health_error(std::uint8_t code) {
    return {0xA5, 0x5A, 3, 0, 0, 0, 0x06, 2, code, 0};
}

class FaultsAtRunTime : public testing::Test {
protected:
    explicit FaultsAtRunTime(std::string_view key = "a1m8", const EmulatorSettings& settings = {})
        : host(key, settings) {}

    void set(const Faults& faults) { host.emulator.set_faults(faults, host.now); }
    bool suffer(Incident incident, std::uint32_t value = 0) {
        return host.emulator.suffer(incident, value, host.now);
    }
    void scan() {
        host.switch_on_and_spin_up();
        host.send(Command::scan);
        host.run(100ms);
        ASSERT_GT(host.measurements().size(), 400U);
    }
    Bytes answer(Command command) {
        host.received();
        host.send(command);
        host.run(50ms);
        return host.received();
    }
    std::size_t measured_in(FakeHost::Duration time) {
        host.measurements();
        host.run(time);
        return host.measurements().size();
    }

    FakeHost host;
};

TEST_F(FaultsAtRunTime, AStalledMotorEndsTheSamplesAndLetGoBringsThemBack) {
    scan();
    set({.motor_stall = true});
    host.run(50ms);
    EXPECT_EQ(measured_in(3s), 0U);
    set({});
    host.run(host.persona.motor.spin_up);
    EXPECT_GT(measured_in(1s), 9'000U);
}

TEST_F(FaultsAtRunTime, AForcedOneMeasuresOnWhileItsHeadStands) {
    scan();
    set({.motor_stall = true, .forced = true});
    host.run(5s);
    host.measurements();
    host.run(1s);
    const auto bytes = host.measurements();
    ASSERT_GT(bytes.size(), 9'000U);
    for (std::size_t at = 5; at + 5 <= bytes.size(); at += 5) {
        ASSERT_EQ(bytes[at + 1], bytes[1]);
        ASSERT_EQ(bytes[at + 2], bytes[2]);
    }
}

TEST_F(FaultsAtRunTime, AStalledMotorObeysAndShowsItWhenLetGo) {
    set({.motor_stall = true});
    host.send(protocol::encode(protocol::set_motor_pwm_request(0)));
    set({});
    EXPECT_THAT(host.events, Contains(Occurrence::motor_off));
    host.send(Command::scan);
    host.run(3s);
    EXPECT_THAT(host.measurements(), IsEmpty());
}

TEST_F(FaultsAtRunTime, ASlowSpinUpTakesItsTime) {
    FakeHost slow("c1", {.faults = {.slow_spin_up = 8s}});
    slow.send(Command::scan);
    slow.run(7900ms);
    EXPECT_THAT(slow.measurements(), IsEmpty());
    slow.run(500ms);
    EXPECT_FALSE(slow.measurements().empty());
}

TEST_F(FaultsAtRunTime, ASlowSpinUpThatBeginsInTheMidstOfOneCounts) {
    FakeHost slow("c1");
    slow.send(Command::scan);
    slow.run(100ms);
    slow.emulator.set_faults({.slow_spin_up = 8s}, slow.now);
    slow.run(5s);
    EXPECT_THAT(slow.measurements(), IsEmpty());
    slow.emulator.set_faults({}, slow.now);
    slow.run(slow.persona.motor.spin_up);
    EXPECT_FALSE(slow.measurements().empty());
}

TEST_F(FaultsAtRunTime, AMuteOneSaysNothingAndThenGoesOn) {
    scan();
    set({.mute = true});
    host.run(200ms);  // what is on the line still comes
    EXPECT_EQ(measured_in(1s), 0U);
    set({});
    EXPECT_GT(measured_in(1s), 9'000U);
}

TEST_F(FaultsAtRunTime, ADeafOneScansOnWhateverItIsTold) {
    scan();
    set({.deaf = true});
    host.send(Command::stop);
    EXPECT_GT(measured_in(1s), 9'000U);
    set({});
    host.send(Command::stop);
    host.run(50ms);
    EXPECT_EQ(measured_in(1s), 0U);
}

TEST_F(FaultsAtRunTime, NoiseAndItsEndChangeBytesAndLeaveThemAsTheyAre) {
    scan();
    set({.noise = 0.05});
    host.run(1s);
    const auto damaged = host.emulator.damage();
    EXPECT_NEAR(static_cast<double>(damaged.damaged), 2000.0 * (1.0 - std::pow(0.95, 5)), 80.0);
    EXPECT_GT(damaged.undetectable, damaged.damaged / 10);
    set({});
    host.run(1s);
    EXPECT_EQ(host.emulator.damage().damaged, damaged.damaged);
    EXPECT_NEAR(static_cast<double>(host.emulator.damage().packets), 4200.0, 30.0);
}

TEST_F(FaultsAtRunTime, GarbageIsAsMuchAsThereWouldBeOfMeasurements) {
    scan();
    set({.garbage = true});
    EXPECT_NEAR(static_cast<double>(measured_in(1s)), 10'000.0, 20.0);
    const auto damage = host.emulator.damage();
    EXPECT_NEAR(static_cast<double>(damage.damaged), 2000.0, 10.0);
    EXPECT_EQ(answer(Command::get_health).size() > health_good.size(), true);
    EXPECT_EQ(answer(Command::get_health), health_good);
}

TEST_F(FaultsAtRunTime, DelayMakesBytesLateAndItsEndBringsThemAtOnce) {
    set({.delay = 300ms});
    host.send(Command::get_health);
    host.run(290ms);
    EXPECT_THAT(host.received(), IsEmpty());
    host.run(20ms);
    EXPECT_EQ(host.received(), health_good);
    host.send(Command::get_health);
    host.run(100ms);
    set({});
    host.run(1ms);
    EXPECT_EQ(host.received(), health_good);
}

TEST_F(FaultsAtRunTime, BurstsBeginAndEndWithoutLoss) {
    scan();
    set({.burst = 100ms});
    host.run(350ms);
    set({});
    host.run(1ms);
    EXPECT_NEAR(static_cast<double>(host.measurements().size()), 3'510.0, 40.0);
    EXPECT_EQ(host.emulator.damage().damaged, 0U);
}

TEST_F(FaultsAtRunTime, AProtectionStopLastsUntilResetAlsoWhenItsCauseIsGone) {
    scan();
    set({.health = {HealthStatus::error, 7}});
    host.run(100ms);
    EXPECT_EQ(measured_in(1s), 0U);
    EXPECT_THAT(host.events, Contains(Occurrence::protection_stop));
    set({});
    EXPECT_EQ(answer(Command::get_health), health_error(7));
    host.send(Command::reset);
    host.run(1s);
    EXPECT_EQ(answer(Command::get_health), health_good);
}

TEST_F(FaultsAtRunTime, AWarningGoesWhenItsCauseDoes) {
    set({.health = {HealthStatus::warning, 7}});
    EXPECT_EQ(answer(Command::get_health)[7], 1);
    set({});
    EXPECT_EQ(answer(Command::get_health), health_good);
}

TEST_F(FaultsAtRunTime, EachScanEndsInAProtectionStopAfterThatTime) {
    set({.protection_stop_after = 500ms});
    host.switch_on_and_spin_up();
    for (int i = 0; i < 2; ++i) {
        host.send(Command::scan);
        host.run(490ms);
        host.measurements();
        host.run(5ms);
        EXPECT_THAT(host.measurements(), Not(IsEmpty()));
        host.run(100ms);
        EXPECT_EQ(answer(Command::get_health), health_error(1));
        EXPECT_THAT(answer(Command::scan), IsEmpty());
        host.send(Command::reset);
        host.run(1s);
        EXPECT_EQ(answer(Command::get_health), health_good);
    }
    set({});
    host.send(Command::scan);
    host.run(1s);
    EXPECT_GT(measured_in(1s), 9'000U);
}

TEST_F(FaultsAtRunTime, AWrongSpeedGarblesBothWays) {
    set({.wrong_baud = 57'600});
    host.emulator.receive(protocol::encode({Command::get_health, {}}), host.now, 115'200);
    host.run(100ms);
    EXPECT_THAT(host.received(), IsEmpty());
    EXPECT_EQ(host.emulator.baud(), 57'600U);
    host.emulator.receive(protocol::encode({Command::get_health, {}}), host.now, 57'600);
    host.run(100ms);
    EXPECT_EQ(host.received(), health_good);
    set({});
    EXPECT_EQ(host.emulator.baud(), 115'200U);
}

TEST_F(FaultsAtRunTime, DescriptorsLieAboutTheirLengthAndKeepTheirMode) {
    set({.lying_length = 0x3FFF'FFFF});
    EXPECT_EQ(
        answer(Command::get_health),
        (Bytes{0xA5, 0x5A, 0xFF, 0xFF, 0xFF, 0x3F, 0x06, 0, 0, 0})
    );
    set({.lying_length = 0});
    host.spin_up();
    const auto scan = answer(Command::scan);
    EXPECT_EQ(Bytes(scan.begin(), scan.begin() + 7), (Bytes{0xA5, 0x5A, 0, 0, 0, 0x40, 0x81}));
}

TEST_F(FaultsAtRunTime, HalfAnswersAreHalvesOfEach) {
    set({.half_answers = true});
    EXPECT_EQ(answer(Command::get_health), Bytes(health_good.begin(), health_good.begin() + 5));
    EXPECT_EQ(answer(Command::get_health).size(), 5U);
    set({});
    EXPECT_EQ(answer(Command::get_health), health_good);
}

TEST_F(FaultsAtRunTime, AHalfAnswerIsOne) {
    EXPECT_TRUE(suffer(Incident::half_answer));
    EXPECT_EQ(answer(Command::get_health).size(), 5U);
    EXPECT_EQ(answer(Command::get_health), health_good);
}

TEST_F(FaultsAtRunTime, LeftoversBeginAtOnce) {
    set({.leftovers = true});
    EXPECT_NE(host.emulator.scan_mode(), nullptr);
    host.run(3s);
    EXPECT_GT(host.measurements().size(), 1000U);
}

TEST_F(FaultsAtRunTime, ABannerComesInTheMidstOfAPacketAndTheScanGoesOn) {
    host.spin_up();
    host.send(Command::scan);
    host.run(100ms);
    EXPECT_TRUE(suffer(Incident::banner));
    host.run(900ms);
    const auto text = host.persona.boot_text;
    auto bytes = host.received();
    bytes.erase(bytes.begin(), bytes.begin() + 7);  // the descriptor
    const auto found = std::search(bytes.begin(), bytes.end(), text.begin(), text.end());
    ASSERT_NE(found, bytes.end());
    EXPECT_NE((found - bytes.begin()) % 5, 0);
    EXPECT_NEAR(static_cast<double>(bytes.size()), 10'000.0 + static_cast<double>(text.size()), 30);
    EXPECT_EQ(host.emulator.damage().damaged, 1U);
}

TEST_F(FaultsAtRunTime, ABannerOfOneThatDoesNotScanComesAtOnce) {
    EXPECT_TRUE(suffer(Incident::banner));
    host.run(50ms);
    EXPECT_EQ(host.received().size(), host.persona.boot_text.size());
}

TEST_F(FaultsAtRunTime, ARebootForgetsTheScanAndBoots) {
    scan();
    EXPECT_TRUE(suffer(Incident::reboot));
    EXPECT_EQ(host.emulator.scan_mode(), nullptr);
    host.received();
    host.run(host.persona.boot_time + 100ms);
    const auto bytes = host.received();
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), host.persona.boot_text);
    EXPECT_EQ(answer(Command::get_health), health_good);
    EXPECT_THAT(host.events, Contains(Occurrence::restarted));
}

TEST_F(FaultsAtRunTime, AfterARebootTheMotorIsAsTheModels) {
    for (const auto* key : {"a1m8", "a3m1", "s2", "c1"}) {
        FakeHost other(key);
        other.switch_on_and_spin_up();
        other.emulator.suffer(Incident::reboot, 0, other.now);
        other.run(5s);
        other.send(Command::scan);
        other.run(100ms);
        // An A1's turns whenever it has power; an A3's waits for its PWM; the others start for a
        // scan and need their time.
        EXPECT_EQ(!other.measurements().empty(), std::string_view(key) == "a1m8") << key;
    }
}

TEST_F(FaultsAtRunTime, AProtectionStopThatHappensOnceGoesWithReset) {
    scan();
    EXPECT_TRUE(suffer(Incident::protection_stop, 9));
    EXPECT_EQ(host.emulator.scan_mode(), nullptr);
    host.run(100ms);
    EXPECT_EQ(answer(Command::get_health), health_error(9));
    host.send(Command::reset);
    host.run(1s);
    EXPECT_EQ(answer(Command::get_health), health_good);
}

TEST_F(FaultsAtRunTime, LossTakesTheNextBytes) {
    EXPECT_TRUE(suffer(Incident::loss, 4));
    EXPECT_EQ(answer(Command::get_health), Bytes(health_good.begin() + 4, health_good.end()));
}

TEST_F(FaultsAtRunTime, AnAngleRestartNeedsAScan) {
    EXPECT_FALSE(suffer(Incident::angle_restart));
}

TEST(AngleRestart, IsMarkedInTheNextCapsuleAndNoOther) {
    FakeHost host("a1m8");
    host.spin_up();
    host.send(protocol::encode(protocol::express_scan_request(1)));
    host.run(500ms);
    host.emulator.suffer(Incident::angle_restart, 0, host.now);
    host.run(500ms);
    const auto bytes = host.measurements();
    constexpr std::size_t size = 84;
    std::size_t restarts = 0;
    for (std::size_t at = 0; at + size <= bytes.size(); at += size) {
        restarts += (bytes[at + 3] & 0x80U) != 0 ? 1U : 0U;
    }
    EXPECT_EQ(restarts, 2U);  // and the first
}

TEST(Truth, IsEveryPacketAsItWasMeasured) {
    for (const auto* key : {"a1m8", "a3m1", "s2", "s3"}) {
        Bytes measured;
        StreamId stream;
        EmulatorSettings settings{
            .faults = {.noise = 0.1, .drop = 0.1, .duplicate = 0.1},
            .on_measured = [&](const Measured& packet) {
                measured.insert(measured.end(), packet.bytes.begin(), packet.bytes.end());
                stream = packet.stream;
            }};
        FakeHost bad(key, settings);
        FakeHost good(key);
        Bytes received;
        for (auto* host : {&bad, &good}) {
            host->switch_on_and_spin_up();
            const auto mode = static_cast<std::uint8_t>(host->persona.typical_mode);
            host->send(protocol::encode(protocol::express_scan_request(mode)));
            host->run(1s);
            received = host->measurements();
        }
        ASSERT_GT(received.size(), 1'000U) << key;
        ASSERT_GE(measured.size(), received.size());
        measured.resize(received.size());
        EXPECT_EQ(measured, received) << key;
        EXPECT_EQ(stream, (StreamId{1, good.persona.modes[good.persona.typical_mode].answer}));
    }
}

TEST(FloodPiece, IsTheLastPacketOnceThereIsOne) {
    FakeHost host("a1m8");
    EXPECT_FALSE(host.emulator.flood_piece().empty());
    host.spin_up();
    host.send(Command::scan);
    host.run(1s);
    EXPECT_EQ(host.emulator.flood_piece().size(), 5U);
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
