// Which lidars serve takes.
#include "server/cli/lidar_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <cstdlib>
#include <sstream>

namespace sweepcast::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class LidarChoiceTest : public testing::Test {
protected:
    Result<LidarChoice, Problem>
    choose(const std::vector<std::string>& named, std::vector<std::string> patterns = {}) {
        return choose_lidars(named, std::move(patterns), log_);
    }

    std::ostringstream told_;
    std::shared_ptr<spdlog::logger> log_ = std::make_shared<spdlog::logger>(
        "test",
        std::make_shared<spdlog::sinks::ostream_sink_st>(told_)
    );
};

TEST_F(LidarChoiceTest, LooksForLidarsIfNoneIsNamed) {
    EXPECT_TRUE(choose({})->find);
}

TEST_F(LidarChoiceTest, LooksForNoneBesideThoseNamed) {
    const auto choice = choose({"/dev/ttyUSB0", "udp://robot"});
    ASSERT_TRUE(choice);
    EXPECT_FALSE(choice->find);
    EXPECT_EQ(choice->lidars.size(), 2U);
}

TEST_F(LidarChoiceTest, LooksForMoreIfTheUserSaysWhere) {
    const auto choice = choose({"/dev/ttyUSB0"}, {"/dev/ttyAMA*"});
    ASSERT_TRUE(choice);
    EXPECT_TRUE(choice->find);
    EXPECT_THAT(choice->patterns, ElementsAre("/dev/ttyAMA*"));
}

TEST_F(LidarChoiceTest, TakesALidarNamedTwiceOnce) {
    const auto choice = choose({"tcp://robot", "tcp://robot:20108", "./a", "serial:./a?baud=9600"});
    ASSERT_TRUE(choice);
    EXPECT_EQ(choice->lidars.size(), 2U);
    EXPECT_THAT(told_.str(), HasSubstr("tcp://robot:20108"));
    EXPECT_THAT(told_.str(), HasSubstr("serial:./a?baud=9600"));
}

TEST_F(LidarChoiceTest, TakesVirtualLidarsAsOftenAsTheyAreNamed) {
    EXPECT_EQ(choose({"virtual:a1m8", "virtual:a1m8"})->lidars.size(), 2U);
    EXPECT_THAT(told_.str(), IsEmpty());
}

TEST_F(LidarChoiceTest, RefusesAWrongUrlBeforeAnythingIsLookedAt) {
    EXPECT_FALSE(choose({"usb://1"}, {"/dev/ttyAMA*"}));
}

TEST_F(LidarChoiceTest, IsAVirtualLidarIfThereIsNone) {
    LidarChoice choice;
    stand_in_for_none(choice, *log_);
    ASSERT_EQ(choice.lidars.size(), 1U);
    EXPECT_TRUE(choice.lidars[0].is_stand_in);
    stand_in_for_none(choice, *log_);
    EXPECT_EQ(choice.lidars.size(), 1U);
}

/// Sets the environment for one test.
class DiscoverVariable {
public:
    explicit DiscoverVariable(const char* value) { ::setenv("SWEEPCAST_DISCOVER", value, 1); }
    DiscoverVariable(const DiscoverVariable&) = delete;
    DiscoverVariable& operator=(const DiscoverVariable&) = delete;
    ~DiscoverVariable() { ::unsetenv("SWEEPCAST_DISCOVER"); }
};

TEST(PatternsOfEnvironment, AreSplitAtColons) {
    EXPECT_THAT(patterns_of_environment(), IsEmpty());
    const DiscoverVariable set(":/dev/ttyAMA*::/tmp/lidar:");
    EXPECT_THAT(patterns_of_environment(), ElementsAre("/dev/ttyAMA*", "/tmp/lidar"));
}

}  // namespace
}  // namespace sweepcast::cli
