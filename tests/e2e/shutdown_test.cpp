// The end: signals, exit codes, motors.
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>

namespace sweepcast::test {
namespace {

using testing::HasSubstr;

class ShutdownTest : public testing::TestWithParam<int> {};

TEST_P(ShutdownTest, LeavesTheMotorOffTellsTheClientsAndExitsWithZero) {
    VirtualLidarProcess lidar;
    GatewayProcess gateway({"--lidar", lidar.port});
    Subscriber over_tcp("tcp://" + gateway.tcp);
    Subscriber over_websocket("ws://" + gateway.http + "/api/v1/stream?kind=sweep");
    over_tcp.subscribe();
    over_tcp.next_sweep();
    over_websocket.next_sweep();

    gateway.process.signal(GetParam());
    EXPECT_THAT(over_tcp.wait_for_end(), HasSubstr("shutting down"));
    EXPECT_THAT(over_websocket.wait_for_end(), HasSubstr("shutting down"));
    EXPECT_EQ(gateway.process.wait(), 0);
    lidar.process.wait_for_log("motor off");
    lidar.process.wait_for_log("closed by the host");
}

INSTANTIATE_TEST_SUITE_P(Signals, ShutdownTest, testing::Values(SIGINT, SIGTERM));

TEST(Shutdown, WorksWhileALidarIsStarting) {
    VirtualLidarProcess lidar;
    GatewayProcess gateway({"--lidar", lidar.port});
    gateway.process.wait_for_log("starting");
    gateway.process.signal(SIGTERM);
    EXPECT_EQ(gateway.process.wait(), 0);
    lidar.process.wait_for_log("motor off");
}

TEST(Shutdown, WorksWithNoLidarThere) {
    GatewayProcess gateway({"--lidar", "/nonexistent/lidar"});
    gateway.process.wait_for_log("waiting for it");
    gateway.process.signal(SIGTERM);
    EXPECT_EQ(gateway.process.wait(), 0);
}

class TakeOverTest : public testing::TestWithParam<std::string> {};

TEST_P(TakeOverTest, TheNextGatewayScansAfterAKillInMidScan) {
    const VirtualLidarProcess lidar({"--model", GetParam()});
    for (int i = 0; i < 4; ++i) {
        GatewayProcess gateway({"--lidar", lidar.port});
        Subscriber client("tcp://" + gateway.tcp);
        client.subscribe();
        client.next_sweep();
        gateway.process.signal(SIGKILL);  // the lidar goes on sending
        EXPECT_EQ(gateway.process.wait(), 128 + SIGKILL);
    }
}

INSTANTIATE_TEST_SUITE_P(Models, TakeOverTest, testing::Values("a1m8", "c1", "s2"));

}  // namespace
}  // namespace sweepcast::test
