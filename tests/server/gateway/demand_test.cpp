// Demand: when a lidar that nobody watches is let rest.
#include "server/gateway/demand.hpp"

#include <gtest/gtest.h>

namespace sweepcast::gateway {
namespace {

using namespace std::chrono_literals;

constexpr Demand::Time start{1h};

TEST(DemandTest, ALidarThatNobodyEverWatchedTurnsForAWhile) {
    Demand demand(30s, start);
    EXPECT_TRUE(demand.take(false, start + 29s));
    EXPECT_FALSE(demand.take(false, start + 30s));
}

TEST(DemandTest, TheFirstWhoWatchesTurnsItOnAtOnce) {
    Demand demand(30s, start);
    EXPECT_FALSE(demand.take(false, start + 1h));
    EXPECT_TRUE(demand.take(true, start + 1h));
}

TEST(DemandTest, TheTimeCountsFromTheLastWhoWatched) {
    Demand demand(30s, start);
    EXPECT_TRUE(demand.take(true, start + 40s));
    EXPECT_TRUE(demand.take(false, start + 60s));
    EXPECT_TRUE(demand.take(true, start + 65s));
    EXPECT_TRUE(demand.take(false, start + 90s));
    EXPECT_FALSE(demand.take(false, start + 95s));
}

}  // namespace
}  // namespace sweepcast::gateway
