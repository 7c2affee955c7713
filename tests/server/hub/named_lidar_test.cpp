// Which lidar a name means.
#include "server/hub/named_lidar.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace sweepcast::hub {
namespace {

const std::string first_serial = "A0A0A0A0000000000000000000000001";
const std::string second_serial = "A0A0A0A0000000000000000000000002";

TEST(FindNamed, AnIdGoesBeforeTheDigitsThatAnotherLidarShares) {
    const std::vector<LidarNames> lidars{
        {first_serial, first_serial, "ttyUSB0"},
        {"A0A0A0A0", second_serial, "ttyUSB1"},
    };
    EXPECT_EQ(find_named(lidars, "A0A0A0A0").index, 1U);
    EXPECT_EQ(find_named(lidars, first_serial).index, 0U);
    EXPECT_EQ(find_named(lidars, second_serial).index, 1U);
    EXPECT_EQ(find_named(lidars, "ttyUSB0").index, 0U);
}

TEST(FindNamed, ASerialNumberGoesBeforeAPort) {
    const std::vector<LidarNames> lidars{
        {"left", "", "A0A0A0A0"},
        {"right", first_serial, ""},
    };
    EXPECT_EQ(find_named(lidars, "A0A0A0A0").index, 1U);
}

TEST(FindNamed, ANameThatFitsTwoLidarsEquallyWellMeansNeither) {
    const std::vector<LidarNames> lidars{
        {"left", first_serial, "robot"},
        {"right", second_serial, "robot"},
        {"back", "", "A0A0A0A0"},
    };
    for (const auto* name : {"A0A0A0A0", "robot"}) {
        EXPECT_FALSE(find_named(lidars, name).index) << name;
        EXPECT_TRUE(find_named(lidars, name).is_ambiguous) << name;
    }
}

TEST(FindNamed, ABetterFitEndsAnAmbiguity) {
    const std::vector<LidarNames> lidars{
        {"left", first_serial, ""},
        {"right", second_serial, ""},
        {"A0A0A0A0", "", ""},
    };
    EXPECT_EQ(find_named(lidars, "A0A0A0A0").index, 2U);
    EXPECT_FALSE(find_named(lidars, "A0A0A0A0").is_ambiguous);
}

TEST(FindNamed, AnEmptyNameMeansNoLidar) {
    const std::vector<LidarNames> lidars{{"left", "", ""}};
    EXPECT_FALSE(find_named(lidars, "").index);
    EXPECT_FALSE(find_named(lidars, "").is_ambiguous);
    EXPECT_FALSE(find_named(lidars, "A0A0").index);
}

}  // namespace
}  // namespace sweepcast::hub
