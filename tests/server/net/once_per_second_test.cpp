// OncePerSecond, with a clock of the test's own.
#include "server/net/once_per_second.hpp"

#include <gtest/gtest.h>

namespace sweepcast::net {
namespace {

using namespace std::chrono_literals;

const OncePerSecond::Time start{};

TEST(OncePerSecond, TheFirstEventIsReportedAtOnce) {
    OncePerSecond events;
    EXPECT_EQ(events.count(start), 1U);
}

TEST(OncePerSecond, ThoseWithinASecondAreReportedTogetherAfterIt) {
    OncePerSecond events;
    ASSERT_TRUE(events.count(start));
    EXPECT_EQ(events.count(start + 1ms), std::nullopt);
    EXPECT_EQ(events.count(start + 999ms), std::nullopt);
    EXPECT_EQ(events.count(start + 1s), 3U);
}

TEST(OncePerSecond, AReportBeginsANewSecond) {
    OncePerSecond events;
    ASSERT_TRUE(events.count(start));
    ASSERT_TRUE(events.count(start + 5s));
    EXPECT_EQ(events.count(start + 5999ms), std::nullopt);
    EXPECT_EQ(events.count(start + 6s), 2U);
}

}  // namespace
}  // namespace sweepcast::net
