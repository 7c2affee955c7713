// URLs of lidars, right and wrong.
#include "server/gateway/lidar_url.hpp"

#include <gtest/gtest.h>

namespace sweepcast::gateway {
namespace {

TEST(ParseLidarUrl, TakesAPathForASerialPort) {
    const auto url = parse_lidar_url("/dev/ttyUSB0");
    ASSERT_TRUE(url);
    EXPECT_EQ(std::get<SerialLidar>(url->where).path, "/dev/ttyUSB0");
    EXPECT_EQ(port_name(*url), "ttyUSB0");
}

TEST(ParseLidarUrl, ARelativePathIsOneToo) {
    const auto url = parse_lidar_url("lidar");
    ASSERT_TRUE(url);
    EXPECT_EQ(port_name(*url), "lidar");
}

TEST(ParseLidarUrl, ReadsAVirtualLidar) {
    const auto url = parse_lidar_url("virtual:a1m8?world=rooms/my%20kitchen.csv");
    ASSERT_TRUE(url);
    EXPECT_EQ(std::get<VirtualLidarUrl>(url->where).model, "a1m8");
    EXPECT_EQ(std::get<VirtualLidarUrl>(url->where).world, "rooms/my kitchen.csv");
    EXPECT_EQ(port_name(*url), "virtual-a1m8");
}

class BadLidarUrlTest : public testing::TestWithParam<const char*> {};

TEST_P(BadLidarUrlTest, IsRefusedWithExamples) {
    const auto url = parse_lidar_url(GetParam());
    ASSERT_FALSE(url);
    EXPECT_NE(url.error().cause.find(GetParam()), std::string::npos);
    EXPECT_NE(url.error().hint.find("virtual:a1m8"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Texts,
    BadLidarUrlTest,
    testing::Values("", "virtual:", "virtual:a1m8?wurld=x", "usb://1", "virtual:a1m8?world=%zz")
);

}  // namespace
}  // namespace sweepcast::gateway
