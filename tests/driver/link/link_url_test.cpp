// URLs of links, right and wrong.
#include "driver/link/link_url.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

namespace sweepcast::link {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Good {
    const char* text;
    std::variant<SerialPlace, TcpPlace, UdpPlace> where;
    const char* short_name;
};

void PrintTo(const Good& good, std::ostream* out) {
    *out << good.text;
}

class GoodLinkUrlTest : public testing::TestWithParam<Good> {};

TEST_P(GoodLinkUrlTest, IsRead) {
    const auto url = parse_link_url(GetParam().text);
    ASSERT_TRUE(url) << url.error().cause;
    EXPECT_EQ(url->where, GetParam().where);
    EXPECT_EQ(url->text, GetParam().text);
    EXPECT_EQ(short_name(*url), GetParam().short_name);
}

const char* const with_colons = "/dev/serial/by-path/pci-0000:00:14.0-usb-0:1:1.0-port0";

INSTANTIATE_TEST_SUITE_P(
    Texts,
    GoodLinkUrlTest,
    testing::Values(
        Good{"/dev/ttyUSB0", SerialPlace{"/dev/ttyUSB0", {}}, "ttyUSB0"},
        Good{"/dev/ttyUSB0?baud=256000", SerialPlace{"/dev/ttyUSB0", 256000}, "ttyUSB0"},
        Good{"serial:/dev/ttyUSB0", SerialPlace{"/dev/ttyUSB0", {}}, "ttyUSB0"},
        Good{"serial:/dev/ttyUSB0?baud=1000000", SerialPlace{"/dev/ttyUSB0", 1000000}, "ttyUSB0"},
        Good{"serial:///dev/my%20lidar", SerialPlace{"/dev/my lidar", {}}, "my lidar"},
        Good{"/tmp/100%25", SerialPlace{"/tmp/100%25", {}}, "100%25"},
        Good{"lidar", SerialPlace{"lidar", {}}, "lidar"},
        Good{"./odd:name", SerialPlace{"./odd:name", {}}, "odd:name"},
        Good{with_colons, SerialPlace{with_colons, {}}, "pci-0000:00:14.0-usb-0:1:1.0-port0"},
        Good{"tcp://robot", TcpPlace{"robot", 20108}, "robot"},
        Good{"tcp://robot/", TcpPlace{"robot", 20108}, "robot"},
        Good{"tcp://192.168.0.7:4001", TcpPlace{"192.168.0.7", 4001}, "192.168.0.7"},
        Good{"tcp://[fe80::1]:4001", TcpPlace{"fe80::1", 4001}, "fe80::1"},
        Good{"udp://192.168.11.2", UdpPlace{"192.168.11.2", 8089}, "192.168.11.2"},
        Good{"udp://[::1]", UdpPlace{"::1", 8089}, "::1"},
        Good{"udp://lidar.local:65535", UdpPlace{"lidar.local", 65535}, "lidar.local"}
    )
);

struct Bad {
    const char* text;
    const char* cause;
};

void PrintTo(const Bad& bad, std::ostream* out) {
    *out << bad.text;
}

class BadLinkUrlTest : public testing::TestWithParam<Bad> {};

TEST_P(BadLinkUrlTest, IsRefusedWithItsCauseAndExamples) {
    const auto url = parse_link_url(GetParam().text);
    ASSERT_FALSE(url);
    EXPECT_THAT(url.error().cause, HasSubstr(GetParam().text));
    EXPECT_THAT(url.error().cause, HasSubstr(GetParam().cause));
    EXPECT_FALSE(url.error().hint.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Texts,
    BadLinkUrlTest,
    testing::Values(
        Bad{"", "names no serial port"},
        Bad{"?baud=115200", "names no serial port"},
        Bad{"serial:", "names no serial port"},
        Bad{"serial:/dev/a%00b", "zero byte"},
        Bad{"serial://host/dev/ttyUSB0", "has no host"},
        Bad{"/dev/ttyUSB0?baud=fast", "\"fast\" is no line speed"},
        Bad{"/dev/ttyUSB0?baud=", "is no line speed"},
        Bad{"/dev/ttyUSB0?baud=0", "is no line speed"},
        Bad{"/dev/ttyUSB0?baud=115200x", "is no line speed"},
        Bad{"/dev/ttyUSB0?baud=99999999999999999999", "is no line speed"},
        Bad{"/dev/ttyUSB0?speed=1", "unknown parameter \"speed\""},
        Bad{"/dev/ttyUSB0?%zz", "not well-formed"},
        Bad{"usb://1", "\"usb:\" is not known"},
        Bad{"http://robot/", "\"http:\" is not known"},
        Bad{"COM3:", "\"COM3:\" is not known"},
        Bad{"tcp:robot", "names no host"},
        Bad{"tcp://", "names no host"},
        Bad{"tcp://:20108", "names no host"},
        Bad{"tcp://robot:x", "not a number"},
        Bad{"tcp://robot:0", "from 1 to 65535"},
        Bad{"tcp://robot:70000", "from 1 to 65535"},
        Bad{"tcp://robot:99999", "from 1 to 65535"},
        Bad{"tcp://robot:18446744073709571724", "from 1 to 65535"},
        Bad{"tcp://robot:20108/path", "more than a host"},
        Bad{"tcp://me@robot", "more than a host"},
        Bad{"tcp://robot#1", "more than a host"},
        Bad{"tcp://robot?baud=115200", "no baud rate"},
        Bad{"udp://robot?size=1", "unknown parameter \"size\""},
        Bad{"tcp://[::1", "not a well-formed URL"},
        Bad{"tcp://%zz", "not a well-formed URL"}
    )
);

TEST(ParseLinkUrl, LeavesParametersThatAreNotTheLinksToTheCaller) {
    std::vector<UrlParameter> others;
    const auto port = parse_link_url("/dev/ttyUSB0?name=left%20one&baud=256000&hz=7", others);
    ASSERT_TRUE(port);
    EXPECT_EQ(std::get<SerialPlace>(port->where), (SerialPlace{"/dev/ttyUSB0", 256000}));
    EXPECT_THAT(others, ElementsAre(UrlParameter{"name", "left one"}, UrlParameter{"hz", "7"}));
    const auto host = parse_link_url("udp://robot?mode=0", others);
    ASSERT_TRUE(host);
    EXPECT_THAT(others, ElementsAre(UrlParameter{"mode", "0"}));
}

TEST(ParseLinkUrl, SaysHowToWriteAPathThatLooksLikeAUrl) {
    const auto url = parse_link_url("odd:name");
    ASSERT_FALSE(url);
    EXPECT_THAT(url.error().hint, HasSubstr("./odd:name"));
}

}  // namespace
}  // namespace sweepcast::link
