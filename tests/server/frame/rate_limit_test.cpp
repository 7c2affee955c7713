// RateLimit: how many sweeps go out, and how evenly.
#include "server/frame/rate_limit.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace sweepcast::frame {
namespace {

using namespace std::chrono_literals;

/// Which of so many sweeps go out, as a line of x and dots. The time from one to the next wavers
/// by as much as `jitter`.
std::string passed(
    std::chrono::microseconds interval,
    std::chrono::microseconds period,
    std::chrono::microseconds jitter,
    int sweeps
) {
    std::mt19937_64 random(1);  // NOLINT(cert-msc51-cpp): the same wavering in every run
    RateLimit limit(interval);
    std::string line;
    for (int i = 0; i < sweeps; ++i) {
        const auto off = std::chrono::microseconds(static_cast<std::int64_t>(
            random() % (2 * static_cast<std::uint64_t>(jitter.count()) + 1)
        ));
        const protocol::SampleTime begin(1s + i * period + off - jitter);
        line += limit.lets_pass(begin, period) ? 'x' : '.';
    }
    return line;
}

TEST(RateLimit, LetsEverythingPassWithoutALimit) {
    EXPECT_EQ(passed(0us, 100ms, 1ms, 5), "xxxxx");
}

TEST(RateLimit, LeavesOutEvenly) {
    EXPECT_EQ(passed(200ms, 100ms, 3ms, 10), "x.x.x.x.x.");
    EXPECT_EQ(passed(500ms, 100ms, 3ms, 12), "x....x....x.");
    EXPECT_EQ(passed(125ms, 100ms, 0ms, 12), "xx.xxxx.xxxx");
}

TEST(RateLimit, ASpeedThatWaversAboutTheLimitCostsNothing) {
    EXPECT_EQ(passed(100ms, 100ms, 5ms, 20), std::string(20, 'x'));
}

TEST(RateLimit, KeepsToTheLimitInTheLongRun) {
    for (const auto interval : {103ms, 110ms, 130ms, 170ms, 199ms, 1234ms}) {
        const auto line = passed(interval, 100ms, 4ms, 10'000);
        const auto count = std::count(line.begin(), line.end(), 'x');
        EXPECT_NEAR(static_cast<double>(count), 1e6 / static_cast<double>(interval.count()), 2.0);
    }
}

TEST(RateLimit, DoesNotMakeUpForAPause) {
    RateLimit limit(200ms);
    EXPECT_TRUE(limit.lets_pass(protocol::SampleTime(1s), 100ms));
    EXPECT_TRUE(limit.lets_pass(protocol::SampleTime(100s), 100ms));
    EXPECT_FALSE(limit.lets_pass(protocol::SampleTime(100s + 100ms), 100ms));
    EXPECT_TRUE(limit.lets_pass(protocol::SampleTime(100s + 200ms), 100ms));
}

TEST(RateLimit, CountsAnewWhenTimesGoBack) {
    for (const auto interval : {0ms, 200ms}) {
        RateLimit limit(interval);
        EXPECT_TRUE(limit.lets_pass(protocol::SampleTime(100s), 100ms));
        EXPECT_TRUE(limit.lets_pass(protocol::SampleTime(50s), 100ms));
        EXPECT_TRUE(limit.lets_pass(protocol::SampleTime(50s + 200ms), 100ms));
    }
}

}  // namespace
}  // namespace sweepcast::frame
