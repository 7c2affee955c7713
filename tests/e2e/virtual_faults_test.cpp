// Virtual lidars that are unplugged and told what to suffer, by every way in.
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <poll.h>
#include <string>
#include <unistd.h>
#include <vector>

namespace sweepcast::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

bool is_there(const std::string& path) {
    return fs::exists(fs::symlink_status(path));
}

/// A port that is held open, as a host does.
class HeldPort {
public:
    explicit HeldPort(const std::string& path)
        : descriptor_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {}
    HeldPort(const HeldPort&) = delete;
    HeldPort& operator=(const HeldPort&) = delete;
    ~HeldPort() { ::close(descriptor_); }

    [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
    /// Whether it is hung up within the test's patience.
    [[nodiscard]] bool hangs_up() const {
        pollfd look{.fd = descriptor_, .events = 0, .revents = 0};
        const auto limit = std::chrono::milliseconds(patience).count();
        return ::poll(&look, 1, static_cast<int>(limit)) == 1 && (look.revents & POLLHUP) != 0;
    }

private:
    int descriptor_;
};

class VirtualFaultsTest : public testing::Test {
protected:
    /// What `sweepcast virtual --control ... --send COMMAND` answers and ends with.
    std::string send(const std::string& command, int code = 0) {
        Process sender({program(), "virtual", "--control", control, "--send", command});
        EXPECT_EQ(sender.wait(), code) << command;
        return sender.rest_of_output() + sender.rest_of_log();
    }

    ScratchDirectory scratch;
    std::string link = scratch.file("lidar");
    std::string control = scratch.file("control");
};

TEST_F(VirtualFaultsTest, UnpluggedByCommandItHangsUpAndIsGoneAndComesBack) {
    VirtualLidarProcess lidar({"--link", link, "--control", control});
    lidar.process.wait_for_log("listening");
    const HeldPort host(link);
    ASSERT_TRUE(host.is_open());
    EXPECT_EQ(send("unplug"), "ok\n");
    EXPECT_TRUE(host.hangs_up());
    EXPECT_FALSE(is_there(link));
    EXPECT_THAT(send("status"), HasSubstr("plugged=no"));
    EXPECT_THAT(send("unplug", 1), HasSubstr("sweepcast: it is unplugged: plug it in first"));
    EXPECT_EQ(send("replug " + scratch.file("other")), "ok\n");
    EXPECT_TRUE(HeldPort(scratch.file("other")).is_open());
    EXPECT_THAT(send("status"), HasSubstr("plugged=yes"));
    lidar.process.signal(SIGTERM);
    EXPECT_EQ(lidar.process.wait(), 0);
    EXPECT_FALSE(is_there(control));
    EXPECT_FALSE(is_there(scratch.file("other")));
}

TEST_F(VirtualFaultsTest, SignalUsr1UnplugsItAndPlugsItInAgain) {
    VirtualLidarProcess lidar({"--link", link});
    lidar.process.wait_for_log("listening");
    lidar.process.signal(SIGUSR1);
    lidar.process.wait_for_log("unplugged");
    EXPECT_FALSE(is_there(link));
    lidar.process.signal(SIGUSR1);
    lidar.process.wait_for_log("listening");
    EXPECT_TRUE(is_there(link));
}

TEST_F(VirtualFaultsTest, AScheduleIsObeyed) {
    VirtualLidarProcess lidar(
        {"--link",
         link,
         "--schedule",
         "100ms unplug, 200ms replug",
         "--schedule",
         "0.3s fault mute"}
    );
    lidar.process.wait_for_log("unplugged");
    lidar.process.wait_for_log("has its power again");
    lidar.process.wait_for_log("faults: mute");
}

TEST_F(VirtualFaultsTest, AGatewayGetsSweepsAgainAfterAReplug) {
    VirtualLidarProcess lidar({"--link", link, "--control", control});
    GatewayProcess gateway({"--lidar", link});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    client.next_sweep();
    send("unplug");
    client.next([](const auto& message) {
        return message.has_lidar() && message.lidar().state() != v1::Lidar::SCANNING;
    });
    send("replug");
    client.wait_for_state(v1::Lidar::SCANNING);
    client.next_sweep();
}

TEST_F(VirtualFaultsTest, AGatewaysOwnVirtualLidarIsUnpluggedByItsSchedule) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8?schedule=3s unplug,4s replug"});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    // A busy machine may not have come to scan before the first of them.
    gateway.process.wait_for_log("unplugged");
    gateway.process.wait_for_log("has its power again");
    const auto replugged = std::chrono::steady_clock::now();
    while (client.next_sweep().scan.sweep.samples.front().time < replugged) {
    }
    gateway.process.signal(SIGTERM);  // killed, it would leave the folder of its link behind
    EXPECT_EQ(gateway.process.wait(), 0);
}

TEST_F(VirtualFaultsTest, AGatewaysOwnVirtualLidarTakesCommands) {
    GatewayProcess gateway({"--lidar", "virtual:s2?control=" + control});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    client.next_sweep();
    EXPECT_EQ(send("fault noise=0.01"), "ok\n");
    const auto status = send("status");
    EXPECT_THAT(status, HasSubstr("scan=DenseBoost faults=noise=0.01"));
    gateway.process.signal(SIGTERM);
    EXPECT_EQ(gateway.process.wait(), 0);
    EXPECT_FALSE(is_there(control));
}

TEST_F(VirtualFaultsTest, TheTruthFileHoldsWhatTheRecordingHasAndUndamaged) {
    const auto truth = scratch.file("truth");
    const auto recording = scratch.file("recording");
    {
        VirtualLidarProcess lidar({"--truth", truth, "--record", recording});
        GatewayProcess gateway({"--lidar", lidar.port});
        Subscriber client("tcp://" + gateway.tcp);
        client.subscribe();
        client.next_sweep();
    }
    std::string measured;
    std::ifstream lines(truth);
    for (std::string line; std::getline(lines, line);) {
        if (line.front() != '#') {
            measured += line.substr(line.rfind(' ') + 1);
        }
    }
    std::string sent;
    std::ifstream bytes(recording, std::ios::binary);
    constexpr const char* digits = "0123456789abcdef";
    for (char c = 0; bytes.get(c);) {
        sent += digits[static_cast<unsigned char>(c) >> 4U];
        sent += digits[static_cast<unsigned char>(c) & 15U];
    }
    ASSERT_GT(sent.size(), 2'000U);
    ASSERT_GE(measured.size(), sent.size());
    EXPECT_EQ(measured.substr(0, sent.size()), sent);
}

}  // namespace
}  // namespace sweepcast::test
