// DamageCount: packets that a line damages, and those that pass all the same.
#include "driver/virtual/damage_count.hpp"

#include "driver/protocol/capsule.hpp"
#include "driver/virtual/bad_line.hpp"
#include "tests/driver/virtual/fake_host.hpp"

#include <gtest/gtest.h>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;
using protocol::AnswerType;

constexpr std::size_t size = protocol::packet_size(AnswerType::express);

Bytes typical_scan(const Persona& persona) {
    const auto mode = static_cast<std::uint8_t>(persona.typical_mode);
    return protocol::encode(protocol::express_scan_request(mode));
}

// A capsule with a right checksum.
Bytes capsule(std::uint8_t filling) {
    Bytes bytes(size, filling);
    protocol::seal_capsule(bytes);
    return bytes;
}

class DamageCountTest : public testing::Test {
protected:
    DamageCountTest() { count_.begin(AnswerType::express); }

    void pass(const Bytes& sent) {
        for (const auto byte : sent) {
            count_.pass(byte, std::span(&byte, 1));
        }
    }
    // All of `sent`, of which `arrived` comes of the byte at `at`.
    void pass(const Bytes& sent, std::size_t at, const Bytes& arrived) {
        for (std::size_t i = 0; i < sent.size(); ++i) {
            count_.pass(sent[i], i == at ? std::span(arrived) : std::span(sent).subspan(i, 1));
        }
    }
    void expect(std::uint64_t packets, std::uint64_t damaged, std::uint64_t undetectable) {
        EXPECT_EQ(count_.counters(), (DamageCounters{packets, damaged, undetectable}));
    }

    DamageCount count_;
};

TEST_F(DamageCountTest, CountsPacketsAndNoDamageWhereThereIsNone) {
    for (int i = 0; i < 10; ++i) {
        pass(capsule(7));
    }
    expect(10, 0, 0);
}

TEST_F(DamageCountTest, CountsAChangedByteThatTheChecksumTells) {
    pass(capsule(1));
    pass(capsule(2), 40, {0xFF});
    pass(capsule(3));
    expect(3, 1, 0);
}

TEST_F(DamageCountTest, CountsTwoEqualChangesThatTheXorDoesNotTell) {
    auto sent = capsule(2);
    for (std::size_t i = 0; i < sent.size(); ++i) {
        const auto byte = static_cast<std::uint8_t>(sent[i] ^ (i == 10 || i == 20 ? 0x55 : 0));
        count_.pass(sent[i], std::span(&byte, 1));
    }
    pass(capsule(3));
    expect(2, 1, 1);
}

TEST_F(DamageCountTest, CountsALostByteOnce) {
    pass(capsule(1), 30, {});
    for (int i = 0; i < 5; ++i) {
        pass(capsule(2));
    }
    expect(6, 1, 0);
}

TEST_F(DamageCountTest, CountsAPacketMadeOfPartsOfTwo) {
    // Of equal bytes, two more or less make no difference to the checksum.
    auto sent = capsule(0x11);
    for (std::size_t i = 0; i < sent.size(); ++i) {
        const auto lost = i >= size - 2;
        count_.pass(
            sent[i],
            lost ? std::span<const std::uint8_t>() : std::span(sent).subspan(i, 1)
        );
    }
    Bytes next{0x22, 0x23};
    pass(next);  // the beginning of the next packet ends the one that lost its own
    EXPECT_EQ(count_.counters().undetectable, 0U);
    Bytes same{0x11, 0x11};
    DamageCount other;
    other.begin(AnswerType::express);
    for (std::size_t i = 0; i < sent.size(); ++i) {
        const auto lost = i >= size - 2;
        other.pass(sent[i], lost ? std::span<const std::uint8_t>() : std::span(sent).subspan(i, 1));
    }
    for (const auto byte : same) {
        other.pass(byte, std::span(&byte, 1));
    }
    EXPECT_EQ(other.counters(), (DamageCounters{2, 1, 1}));
}

TEST_F(DamageCountTest, DoesNotTakeAPacketAfterADoubledByteForAnother) {
    const auto sent = capsule(5);
    pass(capsule(4));
    pass(sent, 0, {sent[0], sent[0]});
    pass(capsule(6));
    expect(3, 1, 0);
}

TEST_F(DamageCountTest, CountsWhatArrivesInTheMidstOfAPacket) {
    const auto sent = capsule(5);
    pass(Bytes(sent.begin(), sent.begin() + 40));
    count_.insert(Bytes{'R', 'P'});
    pass(Bytes(sent.begin() + 40, sent.end()));
    count_.insert(Bytes{'R', 'P'});  // between two packets
    pass(capsule(6));
    expect(2, 1, 0);
}

TEST_F(DamageCountTest, DoesNotBlameTheLineForAPacketThatWasCutOff) {
    pass(Bytes(20, 1));
    count_.begin(AnswerType::express);
    pass(capsule(1));
    expect(2, 0, 0);
}

TEST_F(DamageCountTest, CountsNormalPacketsByTheirCheckBits) {
    const Bytes packet{0x02, 0x01, 0x10, 0x00, 0x20};
    count_.begin(AnswerType::normal);
    pass(packet);
    pass(packet, 2, {0x11});  // no bit that is checked
    pass(packet, 0, {0x03});  // the start bit is its inverse
    pass(packet);
    EXPECT_EQ(count_.counters().packets, 4U);
    EXPECT_EQ(count_.counters().damaged, 2U);
    EXPECT_GE(count_.counters().undetectable, 1U);
}

// Whether bytes are told one by one or together makes no difference.
TEST(DamageCountOfAStream, IsTheSameHoweverItIsTold) {
    for (const auto* key : {"a1m8", "a3m1", "s2"}) {
        FakeHost host(key);
        host.switch_on_and_spin_up();
        host.send(typical_scan(host.persona));
        host.run(2s);
        const auto sent = host.measurements();
        const auto answer = host.persona.modes[host.persona.typical_mode].answer;
        ASSERT_GT(sent.size(), 10'000U);
        DamageCount one_by_one;
        DamageCount together;
        one_by_one.begin(answer);
        together.begin(answer);
        BadLine line({.noise = 0.01, .drop = 0.01, .duplicate = 0.01}, 3);
        std::size_t told = 0;
        for (std::size_t i = 0; i < sent.size(); ++i) {
            const bool bad = i / 997 % 3 == 1;
            Bytes arrived;
            if (bad) {
                line.pass(sent[i], arrived);
            } else {
                arrived.push_back(sent[i]);
            }
            one_by_one.pass(sent[i], arrived);
            if (bad) {
                together.pass_unchanged(std::span(sent).subspan(told, i - told));
                together.pass(sent[i], arrived);
                told = i + 1;
            }
        }
        together.pass_unchanged(std::span(sent).subspan(told));
        EXPECT_EQ(one_by_one.counters(), together.counters()) << key;
        EXPECT_EQ(
            one_by_one.counters().packets,
            (sent.size() + protocol::packet_size(answer) - 1) / protocol::packet_size(answer)
        );
        EXPECT_GT(one_by_one.counters().damaged, 10U);
    }
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
