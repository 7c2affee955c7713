// What only some families of scanners answer: addresses, accessory boards.
#include "driver/protocol/lidar_conf.hpp"
#include "tests/driver/virtual/fake_host.hpp"
#include "tests/driver/virtual/hex.hpp"

#include <gtest/gtest.h>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;
using protocol::ConfType;

Bytes answer(FakeHost& host, const protocol::Request& request) {
    host.send(protocol::encode(request));
    host.run(20ms);
    return host.received();
}

const Bytes ask_static_ip =
    protocol::encode(protocol::get_conf_request(ConfType::static_ip, Bytes{0, 0}));
const protocol::StaticIp new_address{
    .address = {10, 0, 0, 7},
    .netmask = {255, 0, 0, 0},
    .gateway = {10, 0, 0, 1}};

Bytes static_ip_of(FakeHost& host) {
    host.send(ask_static_ip);
    host.run(20ms);
    return host.received();
}

TEST(StaticIp, IsTheFactorysUntilAnotherIsSet) {
    FakeHost host("t1");
    EXPECT_EQ(
        static_ip_of(host),
        from_hex("A5 5A 10 00 00 00 20 C0 CC 01 00 C0 A8 0B 02 FF FF FF 00 C0 A8 0B 01")
    );
    const auto set =
        protocol::set_conf_request(ConfType::static_ip, protocol::encode_static_ip(new_address));
    EXPECT_EQ(answer(host, set), from_hex("A5 5A 08 00 00 00 21 C0 CC 01 00 00 00 00 00"));
    const auto changed =
        from_hex("A5 5A 10 00 00 00 20 C0 CC 01 00 0A 00 00 07 FF 00 00 00 0A 00 00 01");
    EXPECT_EQ(static_ip_of(host), changed);
    host.send(protocol::Command::reset);
    host.run(1s);
    EXPECT_EQ(static_ip_of(host), changed) << "it survives a reset";
}

TEST(StaticIp, IsNotSetByHalfAnAddress) {
    FakeHost host("t1");
    const auto before = static_ip_of(host);
    const auto set = protocol::set_conf_request(ConfType::static_ip, Bytes{10, 0, 0, 7});
    EXPECT_EQ(answer(host, set), from_hex("A5 5A 08 00 00 00 21 C0 CC 01 00 05 80 00 80"));
    EXPECT_EQ(static_ip_of(host), before);
}

TEST(StaticIp, IsUnknownToScannersWithoutEthernet) {
    FakeHost host("s2");
    EXPECT_EQ(static_ip_of(host), from_hex("A5 5A 04 00 00 00 20 C0 CC 01 00"));
    const auto set =
        protocol::set_conf_request(ConfType::static_ip, protocol::encode_static_ip(new_address));
    EXPECT_EQ(answer(host, set), from_hex("A5 5A 08 00 00 00 21 C0 CC 01 00 04 80 00 80"));
}

TEST(MacAddress, IsToldOnlyOnEthernet) {
    const auto ask = protocol::get_conf_request(ConfType::mac_address);
    FakeHost on_ethernet("t1", {.on_ethernet = true});
    EXPECT_EQ(
        answer(on_ethernet, ask),
        from_hex("A5 5A 0A 00 00 00 20 79 00 00 00 02 01 02 03 04 05")
    );
    FakeHost on_a_line("t1");
    EXPECT_EQ(answer(on_a_line, ask), from_hex("A5 5A 04 00 00 00 20 79 00 00 00"));
}

TEST(AccessoryBoard, AnswersWhereThereIsOne) {
    for (const auto& persona : personas()) {
        FakeHost host(persona.key);
        const bool has_one = persona.motor.control == protocol::MotorControl::accessory_board;
        EXPECT_EQ(
            answer(host, protocol::acc_board_flag_request()),
            from_hex(has_one ? "A5 5A 04 00 00 00 FF 01 00 00 00" : "")
        ) << persona.key;
    }
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
