// HostNames: which Host headers are meant for this gateway.
#include "server/http/host_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <unistd.h>

namespace sweepcast::http {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const HostNames hosts({"Robot", "scanner.example.com."});

TEST(HostNames, AddressesAreOurs) {
    for (const auto* header :
         {"127.0.0.1",
          "127.0.0.1:8080",
          "192.168.1.7:80",
          "0.0.0.0:8080",
          "[::1]",
          "[::1]:8080",
          "[FE80::1]:8080",
          "[::ffff:127.0.0.1]:8080"}) {
        EXPECT_EQ(hosts.check(header), HostCheck::ours) << header;
    }
}

TEST(HostNames, LocalhostIsOurs) {
    for (const auto* header :
         {"localhost", "localhost:8080", "LocalHost:8080", "localhost.:8080", "a.localhost"}) {
        EXPECT_EQ(hosts.check(header), HostCheck::ours) << header;
    }
}

TEST(HostNames, GivenNamesAreOursInAnyCaseAndWithADotAtTheEnd) {
    for (const auto* header :
         {"robot", "ROBOT:8080", "robot.", "robot.:8080", "robot:", "Scanner.Example.com:8080"}) {
        EXPECT_EQ(hosts.check(header), HostCheck::ours) << header;
    }
}

TEST(HostNames, OtherNamesAreNot) {
    for (const auto* header :
         {"evil.example",
          "evil.example:8080",
          "robot.evil.example",
          "localhost.evil.example",
          "notlocalhost",
          "127.0.0.1.evil.example",
          "127.1",
          "0x7f000001",
          "2130706433",
          "example.com"}) {
        EXPECT_EQ(hosts.check(header), HostCheck::other) << header;
    }
}

TEST(HostNames, WhatIsNoHostIsMalformed) {
    for (const std::string header :
         {"",           ":8080",   ".",           "..",           "a..b",
          ".robot",     "robot..", "robot:80x",   "robot:80:80",  "robot/",
          "user@robot", "a b",     "::1",         "[::1",         "[::1]8080",
          "[]",         "[robot]", "[127.0.0.1]", "http://robot", "rob\xc3\xb6t"}) {
        EXPECT_EQ(hosts.check(header), HostCheck::malformed) << header;
    }
    EXPECT_EQ(hosts.check(std::string(254, 'a')), HostCheck::malformed);
}

TEST(HostNames, AMachineGoesByItsHostNameTheFirstPartAndTheLocalName) {
    EXPECT_THAT(names_of("Robot.lan."), ElementsAre("robot.lan", "robot", "robot.local"));
    EXPECT_THAT(names_of("robot"), ElementsAre("robot", "robot", "robot.local"));
}

TEST(HostNames, AMachineWhoseHostNameIsNoneHasNoNames) {
    for (const auto* name : {"", ".", "my robot", "rob\xc3\xb6t", "a..b"}) {
        EXPECT_THAT(names_of(name), IsEmpty()) << name;
    }
}

TEST(HostNames, ThisMachinesOwnNamesAreOurs) {
    std::array<char, 256> name{};
    ASSERT_EQ(::gethostname(name.data(), name.size() - 1), 0);
    const auto names = own_host_names();
    EXPECT_EQ(names.empty(), !is_host_name(name.data())) << name.data();
    const HostNames own(names);
    for (const auto& each : names) {
        EXPECT_EQ(own.check(each + ":8080"), HostCheck::ours) << each;
    }
}

}  // namespace
}  // namespace sweepcast::http
