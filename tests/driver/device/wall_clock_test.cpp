// WallClock: steps of UNIX time are told apart from its being kept right.
#include "driver/device/wall_clock.hpp"

#include <gtest/gtest.h>

namespace sweepcast::device {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

class WallClockTest : public testing::Test {
protected:
    /// A reading `later`, after UNIX time was set by `set`.
    WallClock::Relation read(nanoseconds later, nanoseconds set = 0ns, nanoseconds width = 1us) {
        monotonic += later;
        offset += set;
        return clock.take({monotonic, monotonic + offset, width});
    }

    WallClock clock;
    nanoseconds monotonic = 1h;
    nanoseconds offset = 1'700'000'000s;
};

TEST_F(WallClockTest, GivesWhatToAddToAMonotonicTime) {
    EXPECT_EQ(read(0s).monotonic_to_unix, 1'700'000'000s);
}

TEST_F(WallClockTest, TheFirstReadingIsNoStep) {
    EXPECT_EQ(read(0s).step, 0ns);
}

TEST_F(WallClockTest, AStepIsToldOnceWithItsSize) {
    read(0s);
    const auto forward = read(100ms, 2ms);
    EXPECT_EQ(forward.step, 2ms);
    EXPECT_EQ(forward.monotonic_to_unix, 1'700'000'000s + 2ms);
    EXPECT_EQ(read(100ms).step, 0ns);
    EXPECT_EQ(read(100ms, -1h).step, -1h);
    EXPECT_EQ(read(100ms).step, 0ns);
}

TEST_F(WallClockTest, ASlewIsNoStepHoweverLongItLasts) {
    read(0s);
    for (int i = 0; i < 10'000; ++i) {
        EXPECT_EQ(read(100ms, 50us).step, 0ns);  // 500 millionths
        EXPECT_EQ(read(200ms, -100us).step, 0ns);
    }
    EXPECT_EQ(read(10s, 5ms).step, 0ns);
}

TEST_F(WallClockTest, WhatIsMoreThanASlewIsAStep) {
    read(0s);
    EXPECT_EQ(read(10s, 5200us).step, 5200us);
}

TEST_F(WallClockTest, WhatWasReadWithAPauseBetweenIsDoubted) {
    read(0s);
    EXPECT_EQ(read(100ms, 3ms, 4ms).step, 0ns);
    EXPECT_EQ(read(100ms, -3ms).step, 0ns) << "back to what it was: the reading before was off";
}

TEST(ReadClocks, ReadsBothAtOnce) {
    const auto before = std::chrono::steady_clock::now().time_since_epoch();
    const auto reading = read_clocks();
    EXPECT_GE(reading.monotonic, before);
    EXPECT_LE(reading.monotonic, std::chrono::steady_clock::now().time_since_epoch());
    EXPECT_GE(reading.width, 0ns);
    WallClock clock;
    clock.take(reading);
    EXPECT_EQ(clock.take(read_clocks()).step, 0ns);
}

}  // namespace
}  // namespace sweepcast::device
