// ScanStamps: what every sweep of a scan carries besides its samples.
#include "driver/device/scan_stamps.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace sweepcast::device {
namespace {

using namespace std::chrono_literals;

TEST(ScanStamps, ASamplePeriodThatIsNoWholeMicrosecondStaysExact) {
    ScanStamps stamps;
    ScanMode mode;
    mode.sample_duration = 31'250ns;
    stamps.begin_scan(mode);
    const std::vector<protocol::Sample> samples(3);
    const auto progress =
        stamps.stamp({samples, 1, {}}, protocol::AnswerType::dense, protocol::SampleTime{});
    EXPECT_EQ(progress.sample_duration, 31'250ns);
    protocol::Sweep sweep;
    sweep.samples = samples;
    sweep.begun = 1;
    EXPECT_EQ(stamps.stamp(sweep, protocol::AnswerType::dense).sample_duration, 31'250ns);
}

}  // namespace
}  // namespace sweepcast::device
