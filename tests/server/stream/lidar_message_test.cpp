// A lidar's state as a message, and back as another gateway has it.
#include "server/stream/lidar_message.hpp"

#include <gtest/gtest.h>

namespace sweepcast::stream {
namespace {

hub::LidarSnapshot full_snapshot() {
    hub::LidarSnapshot lidar;
    lidar.number = 2;
    lidar.id = "A0E1C2D3";
    lidar.url = "/dev/ttyUSB0";
    auto& state = lidar.state;
    state.phase = device::Phase::scanning;
    state.since =
        std::chrono::system_clock::time_point(std::chrono::milliseconds(1'700'000'000'123));
    state.cause = "a cause";
    state.hint = "a hint";
    state.info = protocol::DeviceInfo{0x18, 1, 29, 7, {0xA0, 0xE1, 0xC2, 0xD3, 1, 2, 3}};
    state.health = protocol::Health{protocol::HealthStatus::warning, 17};
    state.modes = {
        {"Standard",
         protocol::AnswerType::normal,
         std::chrono::nanoseconds(500'000),
         0,
         12'000,
         false},
        {"Express",
         protocol::AnswerType::express,
         std::chrono::nanoseconds(250'000),
         1,
         16'000,
         true}};
    state.mode = "Express";
    state.rotation = {device::SpeedControl::duty, 7, 6.9, true, 5.5, 2, 10, "a warning"};
    state.line = {115'200, 1, 2, 3, 4, 5, "a bad line"};
    state.next_attempt = state.since + std::chrono::seconds(2);
    state.failing_since = state.since - std::chrono::seconds(2);
    state.recoveries = 3;
    state.changes = 17;
    state.recent = {{device::Phase::scanning, device::Phase::stalled, state.since, "silence"}};
    return lidar;
}

TEST(LidarMessageTest, OfAnotherGatewaysChangesOnlySoManyAreKept) {
    v1::Lidar message;
    to_message(full_snapshot(), message);
    const auto change = message.recent(0);
    for (int i = 0; i < 1000; ++i) {
        *message.add_recent() = change;
    }
    EXPECT_EQ(from_message(message).recent.size(), device::recent_changes);
}

TEST(LidarMessageTest, StatesComeBackAsTheyWere) {
    for (const auto phase : device::all_phases) {
        auto lidar = full_snapshot();
        lidar.state.phase = phase;
        v1::Lidar first;
        to_message(lidar, first);
        lidar.state = from_message(first);
        v1::Lidar second;
        to_message(lidar, second);
        EXPECT_EQ(first.DebugString(), second.DebugString());
    }
    v1::Lidar message;
    to_message(full_snapshot(), message);
    EXPECT_EQ(from_message(message).info->serial, full_snapshot().state.info->serial);
    EXPECT_EQ(from_message(message).modes.at(1).sample_duration, std::chrono::microseconds(250));
}

TEST(LidarMessageTest, WhatIsNotToldStaysUnknown) {
    const auto state = from_message(v1::Lidar{});
    EXPECT_EQ(state.phase, device::Phase::disconnected);
    EXPECT_FALSE(state.info);
    EXPECT_FALSE(state.health);
    EXPECT_TRUE(state.modes.empty());
}

TEST(LidarMessageTest, WhatIsMalformedIsTakenForNotTold) {
    v1::Lidar message;
    message.set_state(static_cast<v1::Lidar::State>(99));
    message.mutable_since()->set_seconds(std::numeric_limits<std::int64_t>::max());
    message.mutable_since()->set_nanos(std::numeric_limits<std::int32_t>::max());
    message.mutable_device()->set_serial_number("A0E1");
    message.mutable_device()->set_firmware("one point two");
    message.mutable_device()->set_hardware(4711);
    auto& mode = *message.add_modes();
    mode.set_answer_type(0xFFFF);
    mode.set_samples_per_second(std::numeric_limits<double>::quiet_NaN());
    const auto state = from_message(message);
    EXPECT_EQ(state.phase, device::Phase::disconnected);
    ASSERT_TRUE(state.info);
    EXPECT_EQ(state.info->serial, protocol::DeviceInfo{}.serial);
    EXPECT_EQ(state.info->firmware_major, 0);
    EXPECT_EQ(state.info->hardware, 255);
    EXPECT_EQ(state.modes.at(0).sample_duration.count(), 0);
}

}  // namespace
}  // namespace sweepcast::stream
