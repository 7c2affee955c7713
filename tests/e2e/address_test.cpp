// `sweepcast address` with a lidar on the network, and with one that has no address.
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

namespace sweepcast::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct Outcome {
    int exit_code;
    std::string output, log;
};

Outcome address(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {program(), "address"});
    Process process(arguments);
    const int exit_code = process.wait();
    return {exit_code, process.rest_of_output(), process.rest_of_log()};
}

class AddressTest : public testing::Test {
protected:
    VirtualLidarProcess lidar{{"--model", "t1", "--listen", "udp://127.0.0.1:0"}};
};

TEST_F(AddressTest, IsShown) {
    const auto shown = address({lidar.port});
    EXPECT_EQ(shown.exit_code, 0) << shown.log;
    EXPECT_THAT(shown.output, HasSubstr("model     T1M1\n"));
    EXPECT_THAT(
        shown.output,
        HasSubstr("ip        192.168.11.2\nmask      255.255.255.0\ngateway   192.168.11.1\n")
    );
}

TEST_F(AddressTest, IsSetAndStaysSo) {
    const auto set =
        address({lidar.port, "--ip", "10.0.0.7", "--mask", "255.255.0.0", "--gateway", "10.0.0.1"});
    EXPECT_EQ(set.exit_code, 0) << set.log;
    EXPECT_THAT(set.output, HasSubstr("ip        192.168.11.2     10.0.0.7\n"));
    EXPECT_THAT(set.output, HasSubstr("mask      255.255.255.0    255.255.0.0\n"));
    EXPECT_THAT(set.output, HasSubstr("gateway   192.168.11.1     10.0.0.1\n"));
    EXPECT_THAT(set.output, HasSubstr("switch it off and on, then open udp://10.0.0.7:"));
    const auto shown = address({lidar.port, "--json"});
    EXPECT_THAT(
        shown.output,
        HasSubstr(R"("address":{"ip":"10.0.0.7","mask":"255.255.0.0","gateway":"10.0.0.1"}})")
    );
}

TEST_F(AddressTest, KeepsThePartsThatAreNotGiven) {
    const auto set = address({lidar.port, "--ip", "192.168.11.7", "--json"});
    EXPECT_EQ(set.exit_code, 0) << set.log;
    EXPECT_THAT(
        set.output,
        HasSubstr(
            R"("address":{"ip":"192.168.11.7","mask":"255.255.255.0","gateway":"192.168.11.1"},)"
            R"("before":{"ip":"192.168.11.2","mask":"255.255.255.0","gateway":"192.168.11.1"},)"
            R"("restart_needed":true})"
        )
    );
    const auto again = address({lidar.port, "--ip", "192.168.11.7"});
    EXPECT_EQ(again.exit_code, 0) << again.log;
    EXPECT_THAT(again.output, HasSubstr("nothing was changed"));
}

TEST_F(AddressTest, StaysAsItIsIfTheNewOneCannotWork) {
    const auto set = address({lidar.port, "--ip", "10.0.0.7"});
    EXPECT_EQ(set.exit_code, 1);
    EXPECT_THAT(set.output, IsEmpty());
    EXPECT_THAT(set.log, HasSubstr("the gateway 192.168.11.1 is outside the network of 10.0.0.7"));
    EXPECT_THAT(set.log, HasSubstr("--gateway"));
    EXPECT_THAT(address({lidar.port}).output, HasSubstr("192.168.11.2"));
}

TEST_F(AddressTest, IsShownOfALidarThatSomeoneLeftScanning) {
    {
        GatewayProcess gateway({"--lidar", lidar.port});
        gateway.process.wait_for_log("scanning");
        gateway.process.signal(SIGKILL);  // which leaves it no time to stop the scan
        gateway.process.wait();
    }
    const auto shown = address({lidar.port});
    EXPECT_EQ(shown.exit_code, 0) << shown.log;
    EXPECT_THAT(shown.output, HasSubstr("192.168.11.2"));
}

TEST(Address, WhatHasNoneIsToldSo) {
    const VirtualLidarProcess on_a_port;
    const VirtualLidarProcess behind_a_bridge{{"--model", "s1", "--listen", "tcp://127.0.0.1:0"}};
    for (const auto& port : {on_a_port.port, behind_a_bridge.port}) {
        const auto told = address({port, "--ip", "10.0.0.7"});
        EXPECT_EQ(told.exit_code, 1);
        EXPECT_THAT(told.output, IsEmpty());
        EXPECT_THAT(told.log, HasSubstr("has no address of its own"));
        EXPECT_THAT(told.log, Not(HasSubstr("gateway")));
    }
}

}  // namespace
}  // namespace sweepcast::test
