// How long to wait before the next attempt to connect.
#include "driver/async/backoff.hpp"

#include <gtest/gtest.h>

#include <limits>

using namespace std::chrono_literals;

namespace sweepcast::async {
namespace {

constexpr Backoff schedule{100ms, 1000ms};

TEST(BackoffTest, DoublesUpToTheLongest) {
    EXPECT_EQ(wait_after(1, schedule, 1), 100ms);
    EXPECT_EQ(wait_after(2, schedule, 1), 200ms);
    EXPECT_EQ(wait_after(4, schedule, 1), 800ms);
    EXPECT_EQ(wait_after(5, schedule, 1), 1000ms);
    EXPECT_EQ(wait_after(std::numeric_limits<std::uint32_t>::max(), schedule, 1), 1000ms);
}

TEST(BackoffTest, LuckDrawsFromTheUpperHalf) {
    EXPECT_EQ(wait_after(2, schedule, 0), 100ms);
    EXPECT_EQ(wait_after(2, schedule, 0.5), 150ms);
    EXPECT_EQ(wait_after(9, schedule, 0), 500ms);
}

TEST(BackoffTest, NeverWaitsForNothingAtAll) {
    EXPECT_EQ(wait_after(1, {0ms, 0ms}, 0), 1ms);
    EXPECT_EQ(wait_after(0, schedule, 1), 100ms);
    EXPECT_EQ(wait_after(1, {5000ms, 1000ms}, 1), 1000ms);
}

}  // namespace
}  // namespace sweepcast::async
