// Which lidar belongs to which port, when they answer at others than theirs.
#include "server/gateway/lidar_ports.hpp"

#include <gtest/gtest.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace sweepcast::gateway {
namespace {

class LidarPortsTest : public testing::Test {
protected:
    LidarPortsTest() {
        for (const std::uint32_t number : {1U, 2U}) {
            ports.add(number, port(number), [this, number] { ++moves.at(number - 1); });
        }
    }
    static std::string port(std::uint32_t number) { return "/dev/tty" + std::to_string(number); }
    bool answers(std::uint32_t number, const std::string& serial) {
        return ports.is_it(number, ports.path_of(number), serial);
    }

    LidarPorts ports{
        {},
        [](std::exception_ptr) { FAIL() << "a task failed"; },
        std::make_shared<spdlog::logger>("null", std::make_shared<spdlog::sinks::null_sink_mt>())};
    std::array<int, 2> moves{};
};

TEST_F(LidarPortsTest, TakeWhomeverTheyMeetFirst) {
    EXPECT_TRUE(answers(1, "A"));
    EXPECT_TRUE(answers(2, "B"));
    EXPECT_TRUE(answers(1, "A"));
    EXPECT_EQ(moves, (std::array{0, 0}));
}

TEST_F(LidarPortsTest, GiveALidarThatIsAtAnothersPortThatPort) {
    ASSERT_TRUE(answers(1, "A") && answers(2, "B"));
    ports.lost(1);
    ports.lost(2);
    EXPECT_FALSE(answers(1, "B"));
    EXPECT_EQ(ports.path_of(1), port(2));
    EXPECT_EQ(ports.path_of(2), port(1));
    EXPECT_EQ(moves, (std::array{1, 1}));
    EXPECT_FALSE(ports.is_it(2, port(2), "A")) << "told by the other one before";
    EXPECT_EQ(moves, (std::array{1, 1}));
    EXPECT_TRUE(answers(1, "A"));
    EXPECT_TRUE(answers(2, "B"));
}

TEST_F(LidarPortsTest, GiveALidarThatCameToAPortOfNobodyYetThatPort) {
    ASSERT_TRUE(answers(2, "B"));
    ports.lost(2);
    EXPECT_FALSE(answers(1, "B"));
    EXPECT_EQ(ports.path_of(2), port(1));
}

TEST_F(LidarPortsTest, DoNotTakeAStrangerAtOnce) {
    ASSERT_TRUE(answers(1, "A"));
    ports.lost(1);
    EXPECT_FALSE(answers(1, "C"));
    EXPECT_FALSE(answers(1, "C"));
    EXPECT_TRUE(answers(1, "A"));
    EXPECT_EQ(ports.path_of(1), port(1));
}

TEST_F(LidarPortsTest, TellTwoLidarsOfOneSerialNumberApart) {
    ASSERT_TRUE(answers(1, "0"));
    EXPECT_TRUE(answers(2, "0")) << "the other one is in hand";
    ports.lost(2);
    EXPECT_TRUE(answers(2, "0"));
    EXPECT_EQ(moves, (std::array{0, 0}));
}

}  // namespace
}  // namespace sweepcast::gateway
