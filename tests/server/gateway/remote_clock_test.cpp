// Another machine's clock, learnt from messages that take their time.
#include "server/gateway/remote_clock.hpp"

#include <gtest/gtest.h>

using namespace std::chrono_literals;

namespace sweepcast::gateway {
namespace {

using protocol::SampleTime;

TEST(RemoteClockTest, TheQuickestMessageTells) {
    RemoteClock clock;
    EXPECT_EQ(clock.offset(), 0us);
    clock.hear(SampleTime(1000ms), SampleTime(5030ms));
    EXPECT_EQ(clock.offset(), 4030ms);
    clock.hear(SampleTime(1100ms), SampleTime(5105ms));
    EXPECT_EQ(clock.offset(), 4005ms);
    clock.hear(SampleTime(1200ms), SampleTime(5290ms));
    EXPECT_LT(clock.offset(), 4006ms) << "one that was delayed";
}

TEST(RemoteClockTest, FollowsClocksThatDriftApart) {
    RemoteClock clock;
    // The one there is slow by 100 in a million; each message takes 1 ms.
    for (int second = 0; second < 1000; ++second) {
        const auto here = SampleTime(second * 1'000'000us);
        const auto there = SampleTime(second * 999'900us);
        clock.hear(there, here + 1ms);
        EXPECT_NEAR(static_cast<double>((clock.offset() - (here - there)).count()), 1000, 200)
            << second;
    }
}

TEST(RemoteClockTest, BeginsAnewWhenTheMachineThereDid) {
    RemoteClock clock;
    clock.hear(SampleTime(1h), SampleTime(2h));
    clock.hear(SampleTime(5s), SampleTime(2h + 10s));
    EXPECT_EQ(clock.offset(), 2h + 5s);
    clock.hear(SampleTime(3h), SampleTime(2h + 20s));
    EXPECT_EQ(clock.offset(), 20s - 1h) << "a clock that went ahead";
}

}  // namespace
}  // namespace sweepcast::gateway
