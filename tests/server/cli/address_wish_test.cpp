// Which addresses a lidar may be given.
#include "server/cli/address_wish.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace sweepcast::cli {
namespace {

using protocol::StaticIp;
using testing::HasSubstr;

constexpr StaticIp factory{{192, 168, 11, 2}, {255, 255, 255, 0}, {192, 168, 11, 1}};

/// What is wrong with these parts in place of the factory's; empty: nothing.
std::string fault(const AddressTexts& texts) {
    const auto wish = parse_address_wish(texts);
    if (!wish) {
        return wish.error().cause;
    }
    const auto problem = address_problem(wish->applied_to(factory));
    if (problem) {
        EXPECT_NE(problem->hint, "") << problem->cause;
    }
    return problem ? problem->cause : "";
}

TEST(AddressWish, LeavesWhatIsNotGiven) {
    EXPECT_TRUE(parse_address_wish({})->changes_nothing());
    const auto wish = parse_address_wish({"192.168.11.7", "", ""});
    EXPECT_FALSE(wish->changes_nothing());
    EXPECT_FALSE(wish->is_whole());
    EXPECT_EQ(
        wish->applied_to(factory),
        (StaticIp{{192, 168, 11, 7}, factory.netmask, factory.gateway})
    );
    EXPECT_TRUE(parse_address_wish({"10.0.0.7", "255.0.0.0", "10.0.0.1"})->is_whole());
}

TEST(AddressWish, NamesTheOptionThatIsNoAddress) {
    for (const auto* text : {"10.0.0", "10.0.0.256", "10.0.0.7.1", "robot", "::1", " 10.0.0.7"}) {
        EXPECT_THAT(fault({text, "", ""}), HasSubstr(std::string("--ip ") + text));
        EXPECT_THAT(fault({"", text, ""}), HasSubstr(std::string("--mask ") + text));
        EXPECT_THAT(fault({"", "", text}), HasSubstr(std::string("--gateway ") + text));
    }
}

TEST(AddressWish, TakesSoundAddresses) {
    EXPECT_EQ(fault({}), "");
    EXPECT_EQ(fault({"192.168.11.254", "", ""}), "");
    EXPECT_EQ(fault({"10.0.1.0", "255.255.0.0", "10.0.0.255"}), "");
    EXPECT_EQ(fault({"10.0.0.1", "255.255.255.252", "10.0.0.2"}), "");
}

TEST(AddressWish, RefusesMasksWithGapsOrWithoutRoom) {
    EXPECT_THAT(fault({"", "255.0.255.0", ""}), HasSubstr("ones followed by zeros"));
    EXPECT_THAT(fault({"", "0.0.0.255", ""}), HasSubstr("ones followed by zeros"));
    for (const auto* mask : {"0.0.0.0", "255.255.255.254", "255.255.255.255"}) {
        EXPECT_THAT(fault({"", mask, ""}), HasSubstr("no network"));
    }
}

TEST(AddressWish, RefusesAddressesOfNoHost) {
    EXPECT_THAT(fault({"192.168.11.0", "", ""}), HasSubstr("network address"));
    EXPECT_THAT(fault({"192.168.11.255", "", ""}), HasSubstr("broadcast address"));
    for (const auto* ip : {"0.0.0.7", "127.0.0.1", "224.0.0.1", "255.255.255.255"}) {
        EXPECT_THAT(fault({ip, "", ""}), HasSubstr("cannot be"));
    }
}

TEST(AddressWish, RefusesGatewaysThatCannotBeReached) {
    EXPECT_THAT(fault({"10.0.0.7", "", ""}), HasSubstr("192.168.11.1 is outside"));
    EXPECT_THAT(fault({"", "", "192.168.12.1"}), HasSubstr("outside"));
    EXPECT_THAT(fault({"192.168.11.1", "", ""}), HasSubstr("both the lidar and its gateway"));
    EXPECT_THAT(fault({"", "", "192.168.11.0"}), HasSubstr("--gateway 192.168.11.0"));
    EXPECT_THAT(fault({"", "", "192.168.11.255"}), HasSubstr("broadcast"));
}

}  // namespace
}  // namespace sweepcast::cli
