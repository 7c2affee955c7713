// Sectors become the sweeps that they were cut from.
#include "server/client/sweep_joiner.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace sweepcast::client {
namespace {

Scan sector(std::uint64_t sequence, std::uint32_t number, bool last = false) {
    Scan scan;
    scan.kind = v1::SECTOR;
    scan.sequence = sequence;
    scan.sector = number;
    scan.last = last;
    scan.scan.sweep.samples.resize(2);
    scan.scan.sweep.samples[0].quality = static_cast<std::uint8_t>(number);
    scan.scan.sweep.time_uncertainty = std::chrono::microseconds(number == 1 ? 70 : 20);
    if (last) {
        scan.scan.sweep.period = std::chrono::milliseconds(100);
        scan.scan.sweep.losses.lost_packets = 3;
    }
    return scan;
}

TEST(SweepJoinerTest, SectorsBecomeASweep) {
    SweepJoiner joiner;
    EXPECT_TRUE(joiner.take(sector(7, 0)));
    EXPECT_EQ(joiner.sweep().scan.sweep.samples.size(), 2U);
    EXPECT_TRUE(joiner.take(sector(7, 1)));
    EXPECT_FALSE(joiner.sweep().complete);
    EXPECT_TRUE(joiner.take(sector(7, 2, true)));
    const auto& sweep = joiner.sweep();
    EXPECT_TRUE(sweep.complete);
    EXPECT_EQ(sweep.sequence, 7U);
    ASSERT_EQ(sweep.scan.sweep.samples.size(), 6U);
    EXPECT_EQ(sweep.scan.sweep.samples[4].quality, 2);
    EXPECT_EQ(sweep.scan.sweep.period, std::chrono::milliseconds(100));
    EXPECT_EQ(sweep.scan.sweep.losses.lost_packets, 3U);
    EXPECT_EQ(sweep.scan.sweep.time_uncertainty, std::chrono::microseconds(70)) << "the worst";
    EXPECT_EQ(joiner.lost(), 0U);
}

TEST(SweepJoinerTest, TimesAreUnknownIfThoseOfOneSectorAre) {
    SweepJoiner joiner;
    joiner.take(sector(7, 0));
    auto without = sector(7, 1);
    without.scan.without_times = true;
    joiner.take(without);
    joiner.take(sector(7, 2, true));
    EXPECT_TRUE(joiner.sweep().scan.without_times);
}

TEST(SweepJoinerTest, AWholeSweepIsOne) {
    SweepJoiner joiner;
    Scan sweep;
    sweep.sequence = 3;
    sweep.scan.sweep.samples.resize(5);
    EXPECT_TRUE(joiner.take(sweep));
    EXPECT_TRUE(joiner.sweep().complete);
    EXPECT_EQ(joiner.sweep().scan.sweep.samples.size(), 5U);
}

TEST(SweepJoinerTest, ATurnBegunAnewVoidsWhatCameBefore) {
    SweepJoiner joiner;
    joiner.take(sector(7, 0));
    joiner.take(sector(7, 1));
    const auto begun = joiner.sweep().begun;
    EXPECT_TRUE(joiner.take(sector(7, 0)));
    EXPECT_EQ(joiner.sweep().begun, begun + 1);
    EXPECT_EQ(joiner.sweep().scan.sweep.samples.size(), 2U);
    EXPECT_EQ(joiner.lost(), 0U);
}

TEST(SweepJoinerTest, ASweepWithAMissingSectorIsLostAndTheNextIsNot) {
    SweepJoiner joiner;
    EXPECT_FALSE(joiner.take(sector(6, 3))) << "subscribed in the middle of a turn";
    EXPECT_FALSE(joiner.take(sector(6, 4, true)));
    EXPECT_EQ(joiner.lost(), 1U);
    joiner.take(sector(7, 0));
    EXPECT_FALSE(joiner.take(sector(7, 2)));
    EXPECT_FALSE(joiner.take(sector(7, 3, true)));
    EXPECT_EQ(joiner.lost(), 2U);
    joiner.take(sector(8, 0));
    EXPECT_TRUE(joiner.take(sector(9, 0))) << "the end of 8 is missing";
    EXPECT_EQ(joiner.lost(), 3U);
    EXPECT_TRUE(joiner.take(sector(9, 1, true)));
    EXPECT_TRUE(joiner.sweep().complete);
    EXPECT_EQ(joiner.sweep().scan.sweep.samples.size(), 4U);
}

TEST(SweepJoinerTest, NoSweepGrowsForEver) {
    SweepJoiner joiner;
    joiner.take(sector(1, 0));
    std::uint32_t number = 1;
    while (joiner.take(sector(1, number))) {
        ++number;
        ASSERT_LT(number, 40'000U);
    }
    EXPECT_EQ(joiner.lost(), 1U);
}

}  // namespace
}  // namespace sweepcast::client
