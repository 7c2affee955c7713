// URLs of lidars, right and wrong.
#include "server/gateway/lidar_url.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sweepcast::gateway {
namespace {

using testing::HasSubstr;

TEST(ParseLidarUrl, TakesAPathForASerialPort) {
    const auto url = parse_lidar_url("/dev/ttyUSB0");
    ASSERT_TRUE(url);
    const auto& way = std::get<link::LinkUrl>(url->where);
    EXPECT_EQ(std::get<link::SerialPlace>(way.where).path, "/dev/ttyUSB0");
    EXPECT_EQ(port_name(*url), "ttyUSB0");
}

TEST(ParseLidarUrl, ARelativePathIsOneToo) {
    const auto url = parse_lidar_url("lidar");
    ASSERT_TRUE(url);
    EXPECT_EQ(port_name(*url), "lidar");
}

TEST(ParseLidarUrl, ReadsALidarOnTheNetwork) {
    const auto url = parse_lidar_url("udp://192.168.11.2?hz=7");
    ASSERT_TRUE(url);
    const auto& way = std::get<link::LinkUrl>(url->where);
    EXPECT_EQ(std::get<link::UdpPlace>(way.where).port, 8089);
    EXPECT_EQ(port_name(*url), "192.168.11.2");
}

TEST(ParseLidarUrl, ReadsAVirtualLidar) {
    const auto url = parse_lidar_url("virtual:a1m8?world=rooms/my%20kitchen.csv");
    ASSERT_TRUE(url);
    EXPECT_EQ(std::get<VirtualLidarUrl>(url->where).model, "a1m8");
    EXPECT_EQ(std::get<VirtualLidarUrl>(url->where).world, "rooms/my kitchen.csv");
    EXPECT_EQ(port_name(*url), "virtual-a1m8");
}

TEST(ParseLidarUrl, ReadsTheFaultsOfAVirtualLidar) {
    const auto url = parse_lidar_url("virtual:s2?fault=noise=0.01&fault=protection-stop=0x8001");
    ASSERT_TRUE(url);
    EXPECT_THAT(
        std::get<VirtualLidarUrl>(url->where).faults,
        testing::ElementsAre("noise=0.01", "protection-stop=0x8001")
    );
}

TEST(ParseLidarUrl, ReadsWhatAVirtualLidarIsToSufferAndWhen) {
    const auto url = parse_lidar_url(
        "virtual:a1m8?schedule=5s unplug,7s replug&schedule=9s%20clear&control=/tmp/c&name=left"
    );
    ASSERT_TRUE(url);
    const auto& lidar = std::get<VirtualLidarUrl>(url->where);
    EXPECT_THAT(lidar.schedule, testing::ElementsAre("5s unplug,7s replug", "9s clear"));
    EXPECT_EQ(lidar.control, "/tmp/c");
    EXPECT_EQ(url->name, "left");
}

TEST(ParseLidarUrl, ReadsAnotherGatewaysLidar) {
    const auto url = parse_lidar_url("sweepcast://robot:9000/A0E1C2D3?name=attic");
    ASSERT_TRUE(url);
    const auto& remote = std::get<RemoteLidarUrl>(url->where);
    EXPECT_EQ(remote.host, "robot");
    EXPECT_EQ(remote.port, "9000");
    EXPECT_EQ(remote.id, "A0E1C2D3");
    EXPECT_EQ(url->name, "attic");
    EXPECT_EQ(port_name(*url), "A0E1C2D3");
}

TEST(ParseLidarUrl, AnotherGatewaysOnlyLidarNeedsNoId) {
    for (const auto* text : {"sweepcast://robot", "sweepcast://robot/", "sweepcast://robot:8081"}) {
        const auto url = parse_lidar_url(text);
        ASSERT_TRUE(url) << text;
        EXPECT_EQ(std::get<RemoteLidarUrl>(url->where).port, "8081");
        EXPECT_EQ(std::get<RemoteLidarUrl>(url->where).id, "");
        EXPECT_EQ(port_name(*url), "robot");
    }
    EXPECT_EQ(port_name(*parse_lidar_url("sweepcast://[::1]")), "gateway");
}

TEST(ParseLidarUrl, AnotherGatewaysLidarIsRefusedWithAnExample) {
    for (const auto* text :
         {"sweepcast:",
          "sweepcast://",
          "sweepcast:robot",
          "sweepcast://robot:x",
          "sweepcast://robot:0",
          "sweepcast://robot:65536/A",
          "sweepcast://robot/A/B",
          "sweepcast://robot/..",
          "sweepcast://me@robot/A",
          "sweepcast://robot/A#B"}) {
        const auto url = parse_lidar_url(text);
        ASSERT_FALSE(url) << text;
        EXPECT_THAT(url.error().hint, HasSubstr("sweepcast://robot:8081/A0E1C2D3")) << text;
    }
    EXPECT_THAT(
        parse_lidar_url("sweepcast://robot/A?hz=7").error().cause,
        HasSubstr("its own gateway sets its hz")
    );
}

TEST(ParseLidarUrl, AsksForNothingUnlessTold) {
    const auto url = parse_lidar_url("/dev/ttyUSB0");
    ASSERT_TRUE(url);
    EXPECT_EQ(url->name, "");
    EXPECT_EQ(url->mode, "");
    EXPECT_FALSE(url->hz);
}

class AnyLidarUrlTest : public testing::TestWithParam<const char*> {};

TEST_P(AnyLidarUrlTest, TakesNameModeSpeedAndPatience) {
    const auto text =
        std::string(GetParam()) + "?name=left.1_b-2&mode=Boost&hz=7.5&motor_off_after=30";
    const auto url = parse_lidar_url(text);
    ASSERT_TRUE(url) << url.error().cause;
    EXPECT_EQ(url->name, "left.1_b-2");
    EXPECT_EQ(url->mode, "Boost");
    EXPECT_EQ(url->hz, 7.5);
    EXPECT_EQ(url->motor_off_after, std::chrono::seconds(30));
    EXPECT_EQ(url->text, text);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds,
    AnyLidarUrlTest,
    testing::Values(
        "/dev/ttyUSB0",
        "serial:/dev/ttyUSB0",
        "tcp://robot",
        "udp://robot:1",
        "virtual:s2"
    )
);

class BadLidarUrlTest : public testing::TestWithParam<const char*> {};

TEST_P(BadLidarUrlTest, IsRefusedWithExamples) {
    const auto url = parse_lidar_url(GetParam());
    ASSERT_FALSE(url);
    EXPECT_THAT(url.error().cause, HasSubstr(GetParam()));
    EXPECT_THAT(url.error().hint, HasSubstr("virtual:a1m8"));
}

INSTANTIATE_TEST_SUITE_P(
    Texts,
    BadLidarUrlTest,
    testing::Values(
        "",
        "virtual:",
        "virtual:a1m8?wurld=x",
        "usb://1",
        "virtual:a1m8?world=%zz",
        "/dev/ttyUSB0?world=x",
        "virtual:a1m8?baud=115200"
    )
);

class BadParameterTest : public testing::TestWithParam<const char*> {};

TEST_P(BadParameterTest, IsRefusedAndQuoted) {
    const auto text = std::string("/dev/ttyUSB0?") + GetParam();
    const auto url = parse_lidar_url(text);
    ASSERT_FALSE(url);
    EXPECT_THAT(url.error().cause, HasSubstr(text));
    EXPECT_FALSE(url.error().hint.empty());
}

const std::string too_long = "name=" + std::string(65, 'x');
const std::string mode_too_long = "mode=" + std::string(65, 'x');

INSTANTIATE_TEST_SUITE_P(
    Texts,
    BadParameterTest,
    testing::Values(
        "name=",
        "name=two%20words",
        "name=a/b",
        "name=%00",
        "name=.",
        "name=..",
        too_long.c_str(),
        mode_too_long.c_str(),
        "mode=",
        "hz=",
        "hz=fast",
        "hz=0.9",
        "hz=30.1",
        "hz=-7",
        "hz=nan",
        "hz=inf",
        "motor_off_after=",
        "motor_off_after=0",
        "motor_off_after=1.5",
        "motor_off_after=86401",
        "hz=7Hz"
    )
);

TEST(NameClash, IsTheSameNameTwice) {
    const std::vector<LidarUrl> lidars{
        *parse_lidar_url("/dev/ttyUSB0?name=front"),
        *parse_lidar_url("/dev/ttyUSB1"),
        *parse_lidar_url("/dev/ttyUSB2"),
        *parse_lidar_url("udp://192.168.11.2?name=front")};
    const auto problem = name_clash(lidars);
    ASSERT_TRUE(problem);
    EXPECT_NE(problem->cause.find("front"), std::string::npos);
    EXPECT_NE(problem->cause.find("/dev/ttyUSB0"), std::string::npos);
    EXPECT_NE(problem->cause.find("udp://192.168.11.2"), std::string::npos);
}

TEST(NameClash, IsNoneBetweenNamesThatDifferOrAreNotGiven) {
    const std::vector<LidarUrl> lidars{
        *parse_lidar_url("/dev/ttyUSB0?name=front"),
        *parse_lidar_url("/dev/ttyUSB1?name=back"),
        *parse_lidar_url("/dev/ttyUSB2"),
        *parse_lidar_url("/dev/ttyUSB3")};
    EXPECT_FALSE(name_clash(lidars));
    EXPECT_FALSE(name_clash({}));
}

TEST(ParseLidarUrl, TakesANameOfSixtyFourCharacters) {
    const std::string name(64, 'x');
    const auto url = parse_lidar_url("/dev/ttyUSB0?name=" + name);
    ASSERT_TRUE(url);
    EXPECT_EQ(url->name, name);
}

}  // namespace
}  // namespace sweepcast::gateway
