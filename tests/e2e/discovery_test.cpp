// Lidars that nobody named are found where the user says to look.
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

namespace sweepcast::test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Discovery, FindsLidarsOfDifferentSpeedsBesideTheOneNamed) {
    const ScratchDirectory scratch;
    const VirtualLidarProcess named({"--model", "c1", "--link", scratch.file("named")});
    const VirtualLidarProcess slow({"--model", "a1m8", "--link", scratch.file("lidar-a")});
    const VirtualLidarProcess fast({"--model", "s2", "--link", scratch.file("lidar-s")});
    GatewayProcess gateway(
        {"--lidar",
         scratch.file("named"),
         "--discover",
         scratch.file("lidar-*"),
         "--discover",
         scratch.file("nam*")}
    );
    gateway.process.wait_for_log("not looking at " + scratch.file("named") + ": named by --lidar");
    Subscriber subscriber("tcp://" + gateway.tcp);
    subscriber.subscribe();
    std::set<std::string> scanning;
    while (scanning.size() < 3) {
        for (const auto& lidar : lidars_in(subscriber.next())) {
            if (lidar.state() == v1::Lidar::SCANNING) {
                scanning.insert(lidar.url());
            }
        }
    }
    EXPECT_THAT(
        scanning,
        testing::UnorderedElementsAre(
            scratch.file("named"),
            scratch.file("lidar-a"),
            scratch.file("lidar-s")
        )
    );
}

TEST(Discovery, LeavesAPortInUseAlone) {
    const ScratchDirectory scratch;
    const VirtualLidarProcess lidar({"--model", "a1m8", "--link", scratch.file("lidar")});
    GatewayProcess first({"--lidar", scratch.file("lidar")});
    Subscriber subscriber("tcp://" + first.tcp);
    subscriber.wait_for_state(v1::Lidar::SCANNING);
    GatewayProcess second({"--lidar", "virtual:a1m8", "--discover", scratch.file("lidar")});
    EXPECT_THAT(
        second.process.wait_for_log("not looking at"),
        HasSubstr("in use by sweepcast (process " + std::to_string(first.process.pid()) + ")")
    );
    subscriber.subscribe();
    const auto before = subscriber.next_sweep().sequence;
    EXPECT_EQ(subscriber.next_sweep().sequence, before + 1) << "the scan went on";
}

}  // namespace
}  // namespace sweepcast::test
