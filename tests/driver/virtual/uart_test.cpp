// Uart: what arrives when two ends do not agree on the speed.
#include "driver/virtual/uart.hpp"

#include <gtest/gtest.h>

namespace sweepcast::virtual_lidar {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(Uart, HearsWhatIsSentAtItsSpeedOrNearlyAtIt) {
    const Bytes bytes{0x00, 0xFF, 0xA5, 0x5A};
    EXPECT_EQ(heard(bytes, 115'200, 115'200), bytes);
    EXPECT_EQ(heard(bytes, 256'000, 250'000), bytes) << "2.3 % off";
    EXPECT_EQ(heard(bytes, 250'000, 257'000), bytes) << "2.8 % off";
    EXPECT_EQ(heard(bytes, 0, 115'200), bytes) << "a line without a speed";
    EXPECT_EQ(heard(bytes, 115'200, 0), bytes);
}

TEST(Uart, HearsSeveralBitsAsOneWhenItIsSlower) {
    // 0xA5 on the line is 0 10100101 1, then the line rests. At half the speed the bits heard are
    // the fourth, sixth, eighth and tenth of these, and rest.
    EXPECT_EQ(heard(Bytes{0xA5}, 200, 100), (Bytes{0xF9}));
}

TEST(Uart, HearsEveryBitTwiceWhenItIsTwiceAsFast) {
    // Start bit and the first zeros of 0xF0: five low bits, ten at twice the speed.
    EXPECT_EQ(heard(Bytes{0xF0}, 100, 200), (Bytes{0x00}));
}

TEST(Uart, HearsNoAnswerIntactAtAnyOfTheOtherUsualSpeeds) {
    const Bytes health{0xA5, 0x5A, 3, 0, 0, 0, 0x06, 0, 0, 0};
    for (const std::uint32_t sent : {115'200U, 256'000U, 460'800U, 1'000'000U}) {
        for (const std::uint32_t at : {115'200U, 256'000U, 460'800U, 1'000'000U}) {
            const auto received = heard(health, sent, at);
            EXPECT_EQ(received == health, sent == at) << sent << " heard at " << at;
            EXPECT_FALSE(received.empty());
            EXPECT_LE(received.size(), health.size() * 10);
        }
    }
}

TEST(Uart, HearsTheSameEachTime) {
    const Bytes bytes{0xA5, 0x50, 0x00, 0x13, 0xFE};
    EXPECT_EQ(heard(bytes, 115'200, 256'000), heard(bytes, 115'200, 256'000));
    EXPECT_TRUE(heard({}, 115'200, 256'000).empty());
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
