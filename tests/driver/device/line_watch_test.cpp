// LineWatch: when a line counts as degraded, at times and totals that the tests make up.
#include "driver/device/line_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sweepcast::device {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class LineWatchTest : public testing::Test {
protected:
    /// `time` passes, with 100 packets of 32 samples a second, and of each hundred so many lost.
    void pass(std::chrono::seconds time, std::uint64_t lost) {
        for (auto turn = 0; turn < time / 100ms; ++turn) {
            now += 100ms;
            const auto packets = turn % 10 == 9 ? 10 - lost : 10;
            line.samples += packets * 32;
            line.checksum_errors += 10 - packets;
            watch.take(line, 32, now);
        }
    }

    LineQuality line;
    LineWatch watch;
    std::chrono::steady_clock::time_point now{1h};
};

TEST_F(LineWatchTest, AGoodLineIsNotWarnedOf) {
    pass(60s, 0);
    EXPECT_EQ(watch.warning(), "");
}

TEST_F(LineWatchTest, ALineThatLosesMoreThanOnePartInAHundredIsDegraded) {
    pass(10s, 3);
    EXPECT_THAT(watch.warning(), HasSubstr("loses more than 1 %"));
    EXPECT_THAT(watch.warning(), HasSubstr("cable"));
}

TEST_F(LineWatchTest, HowBadItIsIsToldInStepsAndTheWorstStands) {
    pass(10s, 5);
    EXPECT_THAT(watch.warning(), HasSubstr("more than 3 %"));
    pass(10s, 2);
    EXPECT_THAT(watch.warning(), HasSubstr("more than 3 %"));
}

TEST_F(LineWatchTest, ALineThatLosesLittleIsNot) {
    pass(4s, 0);
    pass(1s, 4);  // once
    pass(4s, 0);
    EXPECT_EQ(watch.warning(), "");
}

TEST_F(LineWatchTest, TheWarningIsWithdrawnOnceTheLineHasBeenGoodForAWhile) {
    pass(10s, 3);
    pass(2s, 0);
    EXPECT_NE(watch.warning(), "");
    pass(6s, 0);
    EXPECT_EQ(watch.warning(), "");
}

TEST_F(LineWatchTest, AnotherScanBeginsAnew) {
    pass(10s, 3);
    watch.restart();
    EXPECT_EQ(watch.warning(), "");
}

}  // namespace
}  // namespace sweepcast::device
