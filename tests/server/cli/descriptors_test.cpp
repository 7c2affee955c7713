// The limit on descriptors, and the connections it leaves room for.
#include "server/cli/descriptors.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <sys/resource.h>

namespace sweepcast::cli {
namespace {

TEST(MostConnections, AreHalfOfWhatIsLeftForEachListener) {
    EXPECT_EQ(most_connections(1024), 480U);
    EXPECT_EQ(most_connections(67), 1U);
    EXPECT_EQ(most_connections(68), 2U);
}

TEST(MostConnections, AreBoundedHoweverManyDescriptorsThereAre) {
    EXPECT_EQ(most_connections(20'063), 9'999U);
    EXPECT_EQ(most_connections(20'064), 10'000U);
    EXPECT_EQ(most_connections(std::numeric_limits<std::size_t>::max()), 10'000U);
}

TEST(MostConnections, AreAtLeastOne) {
    EXPECT_EQ(most_connections(0), 1U);
    EXPECT_EQ(most_connections(64), 1U);
}

TEST(RaiseDescriptorLimit, GoesToTheHardLimit) {
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
    auto lowered = before;
    lowered.rlim_cur = 100;
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &lowered), 0);
    EXPECT_EQ(raise_descriptor_limit(), before.rlim_max);
    rlimit after{};
    ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &after), 0);
    EXPECT_EQ(after.rlim_cur, before.rlim_max);
    EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
}

}  // namespace
}  // namespace sweepcast::cli
