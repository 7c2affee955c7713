// What the state of a lidar in hand says of it, without asking it anything.
#include "driver/diagnosis/diagnose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace sweepcast::diagnosis {
namespace {

using namespace std::chrono_literals;
using device::DeviceState;
using device::Phase;
using testing::HasSubstr;

const link::LinkUrl port{"/dev/ttyUSB0?baud=256000", link::SerialPlace{"/dev/ttyUSB0", 256000}};

/// A lidar that scans and is well.
DeviceState scanning() {
    DeviceState state;
    state.phase = Phase::scanning;
    state.info = protocol::DeviceInfo{.model = 0x31, .firmware_major = 1, .firmware_minor = 25};
    state.health = protocol::Health{};
    state.modes = {
        {.name = "Boost", .answer_type = protocol::AnswerType::ultra, .sample_duration = 63us}};
    state.mode = "Boost";
    state.rotation.wanted_hz = 10;
    state.rotation.measured_hz = 10.1;
    state.line = {.baud = 256000, .bytes = 132'000, .samples = 96'000};
    return state;
}

const Check& check(const Diagnosis& diagnosis, const std::string& id) {
    return *std::ranges::find(diagnosis.checks, id, &Check::id);
}

TEST(InHand, ALidarThatScansWellPassesEveryCheck) {
    const auto diagnosis = diagnosis_of(scanning(), port);
    EXPECT_EQ(diagnosis.port, port.text);
    EXPECT_EQ(diagnosis.checks.size(), chain.size());
    for (const auto& each : diagnosis.checks) {
        EXPECT_EQ(each.verdict, Verdict::ok) << each.id;
    }
    EXPECT_THAT(check(diagnosis, "bytes").finding, HasSubstr("256000 baud"));
    EXPECT_THAT(check(diagnosis, "motor").finding, HasSubstr("Boost"));
}

TEST(InHand, OfAnIdleLidarOnlyAScanCouldTellTheRest) {
    auto state = scanning();
    state.phase = Phase::idle;
    const auto diagnosis = diagnosis_of(state, port);
    EXPECT_EQ(diagnosis.verdict(), Verdict::ok);
    EXPECT_EQ(check(diagnosis, "modes").verdict, Verdict::ok);
    EXPECT_EQ(check(diagnosis, "motor").verdict, Verdict::not_run);
    EXPECT_EQ(check(diagnosis, "speed").verdict, Verdict::not_run);
}

TEST(InHand, AProtectionStopFailsAndEndsTheChain) {
    auto state = scanning();
    state.phase = Phase::protection_stop;
    state.health = protocol::Health{protocol::HealthStatus::error, 0x8001};
    const auto diagnosis = diagnosis_of(state, port);
    EXPECT_EQ(check(diagnosis, "health").verdict, Verdict::failed);
    EXPECT_EQ(check(diagnosis, "modes").verdict, Verdict::not_run);
    EXPECT_THAT(diagnosis.cause, HasSubstr("0x8001"));
}

TEST(InHand, DamageOnTheLineIsTold) {
    auto state = scanning();
    state.line.checksum_errors = 100;  // of 1000 packets
    const auto diagnosis = diagnosis_of(state, port);
    EXPECT_EQ(check(diagnosis, "quality").verdict, Verdict::failed);
    EXPECT_THAT(diagnosis.cause, HasSubstr("10 %"));
}

TEST(InHand, ASpeedThatIsNotReachedIsTold) {
    auto state = scanning();
    state.rotation.measured_hz = 6;
    const auto diagnosis = diagnosis_of(state, port);
    EXPECT_EQ(check(diagnosis, "speed").verdict, Verdict::warning);
    EXPECT_THAT(diagnosis.cause, HasSubstr("too slowly"));
}

TEST(InHand, ANetworkHasNoPortToCheck) {
    auto state = scanning();
    state.line.baud = 0;
    const auto diagnosis =
        diagnosis_of(state, {"udp://10.0.0.2", link::UdpPlace{"10.0.0.2", 8089}});
    EXPECT_EQ(diagnosis.checks.front().id, "open");
    EXPECT_EQ(diagnosis.verdict(), Verdict::ok);
}

}  // namespace
}  // namespace sweepcast::diagnosis
