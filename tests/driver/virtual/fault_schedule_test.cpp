// FaultSchedule: what is due when.
#include "driver/virtual/fault_schedule.hpp"

#include "driver/virtual/error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(FaultSchedule, GivesEachCommandWhenItIsDue) {
    FaultSchedule schedule;
    ASSERT_TRUE(schedule.add("3s unplug, 5s replug /tmp/lidar ,8.5s fault noise=0.02, 1m clear"));
    EXPECT_EQ(schedule.next_due(), 3s);
    EXPECT_EQ(schedule.take_due(2999ms), std::nullopt);
    EXPECT_EQ(schedule.take_due(3s), FaultCommand(Unplug{}));
    EXPECT_EQ(schedule.take_due(3s), std::nullopt);
    EXPECT_EQ(schedule.next_due(), 5s);
    EXPECT_EQ(schedule.take_due(10s), FaultCommand(Replug{"/tmp/lidar"}));
    EXPECT_EQ(schedule.next_due(), 8500ms);
    EXPECT_EQ(schedule.take_due(10s), FaultCommand(SetFault{"noise=0.02"}));
    EXPECT_EQ(schedule.take_due(10s), std::nullopt);
    EXPECT_EQ(schedule.take_due(60s), FaultCommand(ClearFault{}));
    EXPECT_EQ(schedule.next_due(), std::nullopt);
    EXPECT_EQ(schedule.take_due(1000h), std::nullopt);
}

TEST(FaultSchedule, SortsByTimeAndKeepsTheOrderOfWhatIsAtTheSame) {
    FaultSchedule schedule;
    ASSERT_TRUE(schedule.add("2s unplug, 500ms reboot"));
    ASSERT_TRUE(schedule.add("2s replug, 0s banner"));
    EXPECT_EQ(to_text(*schedule.take_due(1h)), "banner");
    EXPECT_EQ(to_text(*schedule.take_due(1h)), "reboot");
    EXPECT_EQ(to_text(*schedule.take_due(1h)), "unplug");
    EXPECT_EQ(to_text(*schedule.take_due(1h)), "replug");
}

TEST(FaultSchedule, IsEmptyAtFirst) {
    FaultSchedule schedule;
    EXPECT_TRUE(schedule.is_empty());
    EXPECT_EQ(schedule.next_due(), std::nullopt);
}

struct Mistake {
    const char* text;
    const char* cause;
};

TEST(FaultSchedule, RefusesTheWholeOfABadOne) {
    for (const auto& [text, cause] : {
             Mistake{"", "does not begin with a time"},
             Mistake{"unplug", "\"unplug\" in the schedule does not begin with a time"},
             Mistake{"3 unplug", "\"3 unplug\""},
             Mistake{"-1s unplug", "begin with a time"},
             Mistake{"nans unplug", "begin with a time"},
             Mistake{"infs unplug", "begin with a time"},
             Mistake{"1441m unplug", "begin with a time"},
             Mistake{"3h unplug", "begin with a time"},
             Mistake{"1s unplug,", "begin with a time"},
             Mistake{"1s unplug,,2s replug", "begin with a time"},
             Mistake{"1s", "no command \"\""},
             Mistake{"1s unplug, 2s fault noise", "\"2s fault noise\" in the schedule: the fault"},
         }) {
        FaultSchedule schedule;
        const auto added = schedule.add(text);
        ASSERT_FALSE(added) << text;
        EXPECT_EQ(added.error().code, errc::invalid_option);
        EXPECT_THAT(added.error().cause, HasSubstr(cause));
        EXPECT_FALSE(added.error().hint.empty());
        EXPECT_TRUE(schedule.is_empty()) << text;
    }
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
