// What a turn between two packets says about packets lost in between.
#include "driver/protocol/turn_rate.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace sweepcast::protocol {
namespace {

TurnRate steady_at(std::int32_t turned) {
    TurnRate rate;
    for (int i = 0; i < 3; ++i) {
        (void)rate.learn(turned);
    }
    return rate;
}

TEST(TurnRateTest, IsNotKnownBeforeThreeTurnsAgree) {
    TurnRate rate;
    EXPECT_EQ(rate.learn(1000), std::nullopt);
    EXPECT_EQ(rate.learn(1000), std::nullopt);
    EXPECT_EQ(rate.packet_times(1000), std::nullopt);
    EXPECT_EQ(rate.learn(1000), 1);
    EXPECT_EQ(rate.packet_times(1000), 1);
}

TEST(TurnRateTest, ASuddenMultipleMeansLostPackets) {
    EXPECT_EQ(steady_at(1000).learn(2000), 2);
    EXPECT_EQ(steady_at(1000).learn(5050), 5);
}

TEST(TurnRateTest, OneLossAfterTheOtherIsSeen) {
    auto rate = steady_at(1000);
    EXPECT_EQ(rate.learn(2000), 2);
    EXPECT_EQ(rate.learn(1000), 1);
    EXPECT_EQ(rate.learn(3000), 3);
}

TEST(TurnRateTest, TwoMultiplesInARowAreAnotherSpeed) {
    auto rate = steady_at(1000);
    EXPECT_EQ(rate.learn(2000), 2);
    EXPECT_EQ(rate.learn(2000), std::nullopt);
    EXPECT_EQ(rate.learn(2000), 1);
    EXPECT_EQ(rate.packet_times(2000), 1);
}

TEST(TurnRateTest, TwoTurnsHaveARateIfTheyAgree) {
    EXPECT_EQ(common_rate(1000, 1050), 1050);
    EXPECT_EQ(common_rate(1000, 2000), std::nullopt);
    EXPECT_EQ(common_rate(0, 0), std::nullopt);
}

TEST(TurnRateTest, WhatWasLostBeforeTheRateWasKnownIsSeenAfterwards) {
    EXPECT_EQ(packet_times_at(1000, 3050), 3);
    EXPECT_EQ(packet_times_at(1000, 2500), std::nullopt);
    EXPECT_EQ(packet_times_at(1000, 1200), 1);
    EXPECT_EQ(packet_times_at(1000, 500), 1) << "it spun up";
}

TEST(TurnRateTest, FollowsASpeedThatDrifts) {
    auto rate = steady_at(1000);
    for (std::int32_t turned = 1000; turned < 3000; turned += 50) {
        ASSERT_EQ(rate.learn(turned), 1) << turned;
    }
    EXPECT_EQ(rate.packet_times(3000), 1);
}

TEST(TurnRateTest, ATurnBetweenMultiplesIsNotExplained) {
    EXPECT_EQ(steady_at(1000).packet_times(1500), std::nullopt);
    EXPECT_EQ(steady_at(1000).packet_times(870), std::nullopt);
    EXPECT_EQ(steady_at(1000).packet_times(2130), std::nullopt);
    EXPECT_EQ(steady_at(1000).learn(1500), std::nullopt);
}

TEST(TurnRateTest, StandstillAndTurningBackAreNeverExplained) {
    EXPECT_EQ(steady_at(0).packet_times(0), std::nullopt);
    EXPECT_EQ(steady_at(1000).packet_times(0), std::nullopt);
    EXPECT_EQ(steady_at(1000).packet_times(-1000), std::nullopt);
    EXPECT_EQ(steady_at(-1000).packet_times(1000), std::nullopt);
}

TEST(TurnRateTest, IsNotKnownAfterARestart) {
    auto rate = steady_at(1000);
    rate.forget();
    EXPECT_EQ(rate.packet_times(1000), std::nullopt);
}

}  // namespace
}  // namespace sweepcast::protocol
