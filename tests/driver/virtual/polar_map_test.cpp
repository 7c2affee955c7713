// PolarMap: files of points, good and bad, and what a beam finds among the points.
#include "driver/virtual/polar_map.hpp"

#include "driver/virtual/error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace sweepcast::virtual_lidar {
namespace {

using testing::HasSubstr;

PolarMap map_of(const std::string& points) {
    auto map = PolarMap::parse("angle_deg,distance_mm\n" + points, "test.csv");
    EXPECT_TRUE(map) << map.error().cause;
    return std::move(*map);
}

TEST(PolarMap, GivesExactlyTheDistanceOfTheNearestPoint) {
    const auto map = map_of("10.0,1000.25\n10.5,2000\n11.0,3000\n");
    EXPECT_EQ(map.distance_mm(10.0), 1000.25);
    EXPECT_EQ(map.distance_mm(10.2), 1000.25);
    EXPECT_EQ(map.distance_mm(10.3), 2000.0);
    EXPECT_EQ(map.distance_mm(10.8), 3000.0);
}

TEST(PolarMap, SeesNothingWhereAPointIsMissing) {
    const auto map = map_of("10,1000\n11,1000\n12,1000\n14,1000\n15,1000\n");
    EXPECT_DOUBLE_EQ(map.reach_deg(), 0.6);
    EXPECT_TRUE(map.distance_mm(12.5));
    EXPECT_FALSE(map.distance_mm(13.0));
    EXPECT_TRUE(map.distance_mm(13.5));
    EXPECT_FALSE(map.distance_mm(180.0));
}

TEST(PolarMap, TakesTheLastAndTheFirstPointForNeighbours) {
    const auto map = map_of("0.1,1000\n0.6,1100\n359.7,2000\n");
    EXPECT_EQ(map.distance_mm(359.95), 1000.0);
    EXPECT_EQ(map.distance_mm(359.85), 2000.0);
    EXPECT_EQ(map.distance_mm(0.0), 1000.0);
    EXPECT_EQ(map.distance_mm(359.5), 2000.0);
}

TEST(PolarMap, TakesAnglesOfAnyTurn) {
    const auto map = map_of("10,1000\n");
    EXPECT_EQ(map.distance_mm(370.0), 1000.0);
    EXPECT_EQ(map.distance_mm(-350.0), 1000.0);
    EXPECT_FALSE(map.distance_mm(-10.0));
}

TEST(PolarMap, TakesTheNearestOfSeveralPointsAtOneAngle) {
    const auto map = map_of("10,1500\n10,1000\n10,2000\n");
    EXPECT_EQ(map.points().size(), 1U);
    EXPECT_EQ(map.distance_mm(10.0), 1000.0);
}

TEST(PolarMap, SortsPointsThatComeInAnyOrder) {
    const auto map = map_of("300,3\n20,1\n150,2\n");
    const std::vector<PolarPoint> expected{{20, 1}, {150, 2}, {300, 3}};
    EXPECT_EQ(map.points(), expected);
}

TEST(PolarMap, DoesNotMakeWallsOfAFewLonePoints) {
    const auto map = map_of("0,1000\n90,1000\n180,1000\n270,1000\n");
    EXPECT_TRUE(map.distance_mm(90.9));
    EXPECT_FALSE(map.distance_mm(92.0));
}

TEST(PolarMap, ReadsBlanksCommentsLineEndsAndByteOrderMark) {
    const auto map = PolarMap::parse(
        "\xEF\xBB\xBF# a room\r\n\r\nangle_deg,distance_mm\r\n 10 , 1000 \r\n# end\r\n20,2e3",
        "x"
    );
    ASSERT_TRUE(map) << map.error().cause;
    const std::vector<PolarPoint> expected{{10, 1000}, {20, 2000}};
    EXPECT_EQ(map->points(), expected);
}

TEST(PolarMap, TakesDistanceZeroForNoEcho) {
    EXPECT_EQ(map_of("10,1000\n20,0\n").points().size(), 1U);
}

struct BadFile {
    const char* name;
    std::string text;
    std::string cause;
};
void PrintTo(const BadFile& file, std::ostream* out) {
    *out << file.name;
}

class BadPolarMap : public testing::TestWithParam<BadFile> {};

TEST_P(BadPolarMap, IsRefusedWithFileLineAndReason) {
    const auto map = PolarMap::parse(GetParam().text, "bad.csv");
    ASSERT_FALSE(map);
    EXPECT_EQ(map.error().code, errc::world_malformed);
    EXPECT_THAT(map.error().cause, HasSubstr("bad.csv"));
    EXPECT_THAT(map.error().cause, HasSubstr(GetParam().cause));
    EXPECT_FALSE(map.error().hint.empty());
}

const std::string header = "angle_deg,distance_mm\n";

INSTANTIATE_TEST_SUITE_P(
    Files,
    BadPolarMap,
    testing::Values(
        BadFile{"empty", "", "is empty"},
        BadFile{"only_header", header, "no point"},
        BadFile{"only_no_echo", header + "5,0\n", "no point"},
        BadFile{"no_header", "1,2\n", "line 1: expected the header"},
        BadFile{"other_header", "angle,distance\n", "line 1: expected the header"},
        BadFile{"no_comma", header + "1,2\n12\n", "line 3: expected angle_deg,distance_mm"},
        BadFile{"word", header + "1,2\n\nleft,5\n", "line 4: the angle \"left\" is not a number"},
        BadFile{"three_columns", header + "1,2,3\n", "line 2: the distance \"2,3\""},
        BadFile{"angle_of_360", header + "360,2\n", "line 2: the angle \"360\" is not in [0, 360)"},
        BadFile{"negative_angle", header + "-1,2\n", "not in [0, 360)"},
        BadFile{"negative_distance", header + "1,-2\n", "the distance \"-2\" is not in 0..100000"},
        BadFile{"far_away", header + "1,100001\n", "is not in 0..100000"},
        BadFile{"nan", header + "nan,1\n", "is not a number"},
        BadFile{"infinite", header + "1,inf\n", "is not a number"},
        BadFile{"out_of_double", header + "1,1e999\n", "is not a number"},
        BadFile{"hex", header + "0x10,1\n", "is not a number"},
        BadFile{"empty_field", header + "1,\n", "the distance \"\" is not a number"},
        BadFile{
            "control_bytes",
            header + "\x1b[2J,1\n",
            "the angle \"\\u001b[2J\" is not a number"},
        BadFile{"zeros", std::string(100, '\0'), "line 1: expected the header"},
        BadFile{
            "cut_in_a_character",
            header + std::string(39, 'x') + "éa,1\n",
            "\"" + std::string(39, 'x') + "...\" is not a number"},
        BadFile{"long_line", header + std::string(5000, 'x') + ",1\n", "xxx...\" is not a number"}
    ),
    [](const auto& test) { return std::string(test.param.name); }
);

TEST(PolarMap, RefusesMorePointsThanItHolds) {
    std::string text = header;
    for (std::size_t i = 0; i <= max_points; ++i) {
        text += "1,1\n";
    }
    const auto map = PolarMap::parse(text, "big.csv");
    ASSERT_FALSE(map);
    EXPECT_THAT(map.error().cause, HasSubstr("more than 500000 points"));
}

TEST(PolarMap, RefusesTextThatIsTooLarge) {
    const auto map = PolarMap::parse(std::string(max_points_file_bytes + 1, '\n'), "big.csv");
    ASSERT_FALSE(map);
    EXPECT_THAT(map.error().cause, HasSubstr("larger than 16 MiB"));
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
