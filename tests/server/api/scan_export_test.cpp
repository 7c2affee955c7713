// A sweep as JSON message and as CSV.
#include "server/api/scan_export.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <limits>

namespace sweepcast::api {
namespace {

device::CapturedSweep two_samples() {
    using std::chrono::microseconds;
    device::CapturedSweep captured;
    captured.lidar = "A0E1C2D3";
    captured.sequence = 5;
    captured.mode = "Express";
    captured.sweep.period = microseconds(200'000);
    captured.monotonic_to_unix = std::chrono::seconds(1'700'000'000);
    captured.sweep.samples = {
        {protocol::SampleTime(microseconds(1'000'000)),
         protocol::DistanceQ2{4001},
         protocol::AngleQ14{16384},
         188,
         1},
        {protocol::SampleTime(microseconds(1'000'250)),
         protocol::DistanceQ2{0},
         protocol::AngleQ14{16450},
         0,
         2},
    };
    return captured;
}

TEST(ToCsv, HasALineASample) {
    EXPECT_EQ(
        to_csv(two_samples()),
        "angle_deg,distance_mm,quality,time_us\n"
        "90.0000,1000.25,188,0\n"
        "90.3625,0.00,0,250\n"
    );
}

TEST(ToMessage, IsInPlainUnits) {
    v1::LatestScan scan;
    to_message(two_samples(), scan);
    EXPECT_EQ(scan.lidar(), "A0E1C2D3");
    EXPECT_EQ(scan.sequence(), 5U);
    EXPECT_DOUBLE_EQ(scan.rotation_hz(), 5.0);
    EXPECT_EQ(scan.time().seconds(), 1'700'000'001);
    ASSERT_EQ(scan.angle_deg_size(), 2);
    EXPECT_DOUBLE_EQ(scan.angle_deg(0), 90.0);
    EXPECT_DOUBLE_EQ(scan.distance_mm(0), 1000.25);
    EXPECT_EQ(scan.quality(0), 188U);
    EXPECT_EQ(scan.time_us(1), 250);
}

TEST(ToMessage, ATimeThatDoesNotFitIsTheLargestThatDoes) {
    auto sweep = two_samples();
    sweep.sweep.samples.back().time += std::chrono::microseconds(std::int64_t{1} << 42U);
    v1::LatestScan scan;
    to_message(sweep, scan);
    EXPECT_EQ(scan.time_us(0), 0);
    EXPECT_EQ(scan.time_us(1), std::numeric_limits<std::int32_t>::max());
}

TEST(ToMessage, TheUnixTimeOfAnyMomentIsInRange) {
    // The moment itself does not fit into 64 bits of nanoseconds.
    auto sweep = two_samples();
    for (auto& sample : sweep.sweep.samples) {
        sample.time = protocol::SampleTime(std::chrono::microseconds(9'225'000'000'000'000));
    }
    sweep.monotonic_to_unix = std::chrono::nanoseconds(1'000'000'001);
    v1::LatestScan scan;
    to_message(sweep, scan);
    EXPECT_EQ(scan.time().seconds(), 9'225'000'001);
    EXPECT_EQ(scan.time().nanos(), 1);
}

TEST(ToMessage, ASweepWithoutSamplesHasNoTime) {
    v1::LatestScan scan;
    to_message(device::CapturedSweep{}, scan);
    EXPECT_FALSE(scan.has_time());
}

}  // namespace
}  // namespace sweepcast::api
