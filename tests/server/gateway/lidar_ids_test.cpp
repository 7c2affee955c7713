// LidarIds: no two lidars of one name.
#include "server/gateway/lidar_ids.hpp"

#include <gtest/gtest.h>

namespace sweepcast::gateway {
namespace {

TEST(LidarIds, GivesTheShortIdWhereItIsFree) {
    LidarIds ids;
    EXPECT_EQ(ids.claim(1, "A0E1C2D3", "A0E1C2D3B4F5"), "A0E1C2D3");
    EXPECT_EQ(ids.claim(1, "A0E1C2D3", "A0E1C2D3B4F5"), "A0E1C2D3");
}

TEST(LidarIds, TellsTwoOfTheSameShortIdApart) {
    LidarIds ids;
    ids.claim(1, "A0E1C2D3", "A0E1C2D3B4F5");
    EXPECT_EQ(ids.claim(2, "A0E1C2D3", "A0E1C2D30000"), "A0E1C2D30000");
}

TEST(LidarIds, TellsTwoOfTheSameNameApart) {
    LidarIds ids;
    ids.claim(1, "virtual-a1m8", "virtual-a1m8");
    EXPECT_EQ(ids.claim(2, "virtual-a1m8", "virtual-a1m8"), "virtual-a1m8-2");
}

TEST(LidarIds, FreesTheNameThatALidarGivesUp) {
    LidarIds ids;
    ids.claim(1, "ttyUSB0", "ttyUSB0");
    ids.claim(1, "A0E1C2D3", "A0E1C2D3B4F5");
    EXPECT_EQ(ids.claim(2, "ttyUSB0", "ttyUSB0"), "ttyUSB0");
}

}  // namespace
}  // namespace sweepcast::gateway
