// What the numbers of frames tell of those that did not come.
#include "server/client/missed_frames.hpp"

#include "server/client/known_lidars.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>

namespace sweepcast::client {
namespace {

v1::Frame sweep(std::uint64_t sequence, std::uint32_t omitted = 0, const char* lidar = "A") {
    v1::Frame frame;
    frame.set_lidar(lidar);
    frame.set_sequence(sequence);
    frame.set_omitted(omitted);
    return frame;
}

v1::Frame sector(std::uint64_t sequence, std::uint32_t number, bool last = false) {
    auto frame = sweep(sequence);
    frame.set_kind(v1::SECTOR);
    frame.set_sector(number);
    frame.set_last(last);
    return frame;
}

TEST(MissedFramesTest, OfSweepsAreTheGapLessWhatWasLeftOut) {
    MissedFrames missed;
    EXPECT_EQ(missed.before(sweep(7)), 0U);
    EXPECT_EQ(missed.before(sweep(8)), 0U);
    EXPECT_EQ(missed.before(sweep(12)), 3U);
    EXPECT_EQ(missed.before(sweep(15, 2)), 0U);
    EXPECT_EQ(missed.before(sweep(20, 1)), 3U);
}

TEST(MissedFramesTest, LidarsAreCountedApart) {
    MissedFrames missed;
    EXPECT_EQ(missed.before(sweep(1, 0, "A")), 0U);
    EXPECT_EQ(missed.before(sweep(100, 0, "B")), 0U);
    EXPECT_EQ(missed.before(sweep(3, 0, "A")), 1U);
}

TEST(MissedFramesTest, AreNoneIfASweepComesAgainOrTheLidarBeganAnew) {
    MissedFrames missed;
    missed.before(sweep(7));
    EXPECT_EQ(missed.before(sweep(7)), 0U);
    EXPECT_EQ(missed.before(sweep(1)), 0U);
    EXPECT_EQ(missed.before(sweep(2)), 0U);
    EXPECT_EQ(missed.before(sweep(4, 9)), 0U) << "more left out than there were";
}

TEST(MissedFramesTest, OfSectorsAreAtLeastThoseThatTheNumbersShow) {
    MissedFrames missed;
    missed.before(sector(1, 0));
    EXPECT_EQ(missed.before(sector(1, 1)), 0U);
    EXPECT_EQ(missed.before(sector(1, 4)), 2U);
    EXPECT_EQ(missed.before(sector(1, 5, true)), 0U);
    EXPECT_EQ(missed.before(sector(2, 0)), 0U);
    EXPECT_EQ(missed.before(sector(3, 0)), 1U) << "the end of the one before";
    EXPECT_EQ(missed.before(sector(6, 2)), 1U + 2U + 2U) << "an end, two sweeps, a beginning";
}

TEST(MissedFramesTest, LeavesOutTheFramesOfMoreLidarsThanMost) {
    MissedFrames missed;
    for (std::size_t i = 0; i < most_lidars; ++i) {
        EXPECT_EQ(missed.before(sweep(1, 0, std::to_string(i).c_str())), 0U);
    }
    EXPECT_EQ(missed.before(sweep(1, 0, "one more")), std::nullopt);
    EXPECT_EQ(missed.before(sweep(3, 0, "0")), 1U) << "those known go on";
}

TEST(MissedFramesTest, LeavesOutFramesWithTooLongAName) {
    MissedFrames missed;
    EXPECT_EQ(missed.before(sweep(1, 0, std::string(longest_lidar_name, 'A').c_str())), 0U);
    EXPECT_EQ(
        missed.before(sweep(1, 0, std::string(longest_lidar_name + 1, 'A').c_str())),
        std::nullopt
    );
}

TEST(MissedFramesTest, AreNoneIfTheTurnBeganAnew) {
    MissedFrames missed;
    missed.before(sector(1, 0));
    missed.before(sector(1, 1));
    EXPECT_EQ(missed.before(sector(1, 0)), 0U);
    EXPECT_EQ(missed.before(sector(1, 1)), 0U);
}

}  // namespace
}  // namespace sweepcast::client
