// Sweeps as columns: which columns a sweep gets, and that every sample comes back.
#include "server/frame/scan_columns.hpp"

#include "server/frame/time_runs.hpp"
#include "sweepcast/v1/scan.pb.h"
#include "tests/server/frame/random_sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace sweepcast::frame {
namespace {

using namespace std::chrono_literals;
using protocol::Sample;
using testing::ElementsAre;
using testing::IsEmpty;

Sample sample(std::uint16_t angle, std::uint32_t distance, std::int64_t time_us = 0) {
    Sample made;
    made.angle.raw = angle;
    made.distance.raw = distance;
    made.time = protocol::SampleTime(std::chrono::microseconds(time_us));
    made.quality = distance == 0 ? std::uint8_t{0} : std::uint8_t{188};
    made.flag = 2;
    return made;
}

device::CapturedSweep sweep_of(std::vector<Sample> samples) {
    device::CapturedSweep captured;
    captured.sweep.samples = std::move(samples);
    return captured;
}

v1::Scan columns_of(const device::CapturedSweep& captured) {
    v1::Scan scan;
    to_columns(whole_sweep(captured), {}, scan);
    return scan;
}

std::vector<Sample> there_and_back(const device::CapturedSweep& captured) {
    return from_columns(columns_of(captured)).value().sweep.samples;
}

TEST(ScanColumns, CountAnglesInSixtyFourthsOfADegreeWhereThatLosesNothing) {
    const auto scan = columns_of(sweep_of({sample(0, 4), sample(16384, 4), sample(65533, 4)}));
    EXPECT_EQ(scan.angle_units_per_turn(), 23040U);
    EXPECT_THAT(scan.angle(), ElementsAre(0, 5760, -5761));
}

TEST(ScanColumns, CountAnglesInTheVendorsUnitsWhereSixtyFourthsWouldLose) {
    const auto scan = columns_of(sweep_of({sample(1, 4), sample(16384, 4)}));
    EXPECT_EQ(scan.angle_units_per_turn(), 65536U);
    EXPECT_THAT(scan.angle(), ElementsAre(1, 16383));
}

TEST(ScanColumns, TakeTheShortWayAroundTheCircle) {
    const auto scan =
        columns_of(sweep_of({sample(65535, 4), sample(1, 4), sample(65535, 4), sample(32767, 4)}));
    EXPECT_THAT(scan.angle(), ElementsAre(65535, 2, -2, -32768));
}

TEST(ScanColumns, CountDistancesInMillimetresWhereThatLosesNothing) {
    const auto scan =
        columns_of(sweep_of({sample(0, 4000), sample(0, 0), sample(0, 4008), sample(0, 4004)}));
    EXPECT_EQ(scan.distance_unit_um(), 1000U);
    EXPECT_THAT(scan.distance(), ElementsAre(2001, 0, 5, 2));
}

TEST(ScanColumns, CountDistancesInQuarterMillimetresOtherwise) {
    const auto scan = columns_of(sweep_of({sample(0, 4000), sample(0, 4001)}));
    EXPECT_EQ(scan.distance_unit_um(), 250U);
    EXPECT_THAT(scan.distance(), ElementsAre(8001, 3));
}

TEST(ScanColumns, LeaveOutAConstantQuality) {
    const auto scan = columns_of(sweep_of({sample(0, 0), sample(0, 4), sample(0, 8)}));
    EXPECT_TRUE(scan.quality().empty());
    EXPECT_EQ(scan.echo_quality(), 188U);
}

TEST(ScanColumns, KeepAQualityThatVaries) {
    auto captured = sweep_of({sample(0, 0), sample(0, 4), sample(0, 8)});
    captured.sweep.samples[0].quality = 1;  // without an echo
    EXPECT_EQ(columns_of(captured).quality(), std::string("\x01\xBC\xBC"));
}

TEST(ScanColumns, ListOnlyTheFlagsThatAreNotTheUsualOne) {
    auto captured =
        sweep_of({sample(0, 4), sample(0, 4), sample(0, 4), sample(0, 4), sample(0, 4)});
    captured.sweep.samples[1].flag = 1;
    captured.sweep.samples[4].flag = 7;
    const auto scan = columns_of(captured);
    EXPECT_EQ(scan.flag(), 2U);
    EXPECT_THAT(scan.flag_index(), ElementsAre(1, 3));
    EXPECT_EQ(scan.flag_value(), std::string("\x01\x07"));
}

TEST(ScanColumns, GiveAnEvenClockOneStep) {
    auto captured = sweep_of({sample(0, 4, 1000), sample(0, 4, 1500), sample(0, 4, 2000)});
    captured.sample_duration = 499us;  // as the lidar reports it, a little wrong
    const auto scan = columns_of(captured);
    EXPECT_THAT(scan.time_run(), ElementsAre(1, 2));
    EXPECT_NEAR(static_cast<double>(scan.time_step_ps(1)), 500e6, 1e6);
    EXPECT_EQ(scan.sample_period_ns(), 499'000U);
}

TEST(ScanColumns, GiveOneStepToAClockWhosePeriodIsNoWholeMicrosecond) {
    for (const std::int64_t period_ns : {31'250, 62'997, 499'001, 999'999, 1'000'003}) {
        std::vector<Sample> samples;
        for (std::int64_t i = 0; i < 3200; ++i) {
            samples.push_back(sample(0, 4, (123 + i * period_ns) / 1000));
        }
        const auto captured = sweep_of(samples);
        const auto scan = columns_of(captured);
        EXPECT_THAT(scan.time_run(), ElementsAre(1, 3199)) << period_ns;
        EXPECT_EQ(there_and_back(captured), captured.sweep.samples) << period_ns;
    }
}

TEST(ScanColumns, BeginANewRunWhereTheClockLeavesItsLine) {
    auto captured =
        sweep_of({sample(0, 4, 1000), sample(0, 4, 1500), sample(0, 4, 2000), sample(0, 4, 2100)});
    EXPECT_THAT(columns_of(captured).time_run(), ElementsAre(1, 2, 1));
    EXPECT_EQ(there_and_back(captured), captured.sweep.samples);
}

TEST(ScanColumns, LeaveOutWhatIsNotWanted) {
    const auto captured = sweep_of({sample(0, 4, 1000), sample(90, 8, 1500), sample(180, 4, 2000)});
    v1::Scan scan;
    FrameFormat format;
    format.leave_out_quality = format.leave_out_flags = format.leave_out_times = true;
    auto content = whole_sweep(captured);
    content.sample_duration = 250us;
    to_columns(content, format, scan);
    const auto decoded = from_columns(scan).value();
    EXPECT_TRUE(decoded.without_quality && decoded.without_flags && decoded.without_times);
    EXPECT_EQ(decoded.sweep.samples[2].quality, 0);
    EXPECT_EQ(decoded.sweep.samples[2].flag, 0);
    for (const auto& each : decoded.sweep.samples) {
        EXPECT_EQ(each.time, protocol::SampleTime(1000us)) << "later times are not made up";
    }
    EXPECT_EQ(decoded.sweep.samples[2].distance.raw, 4U);
}

TEST(ScanColumns, RoundToTheUnitsThatAreWanted) {
    const auto captured = sweep_of({sample(91, 1), sample(16384, 4 * 1006), sample(65500, 0)});
    v1::Scan scan;
    to_columns(
        whole_sweep(captured),
        {.angle_units_per_turn = 360, .distance_unit_um = 10'000},
        scan
    );
    EXPECT_THAT(scan.angle(), ElementsAre(0, 90, -90));
    EXPECT_THAT(scan.distance(), ElementsAre(3, 201, 0));  // an echo stays one: 10 mm, then 1010
    const auto samples = from_columns(scan).value().sweep.samples;
    EXPECT_EQ(samples[1].angle.raw, 16384);
    EXPECT_EQ(samples[1].distance.millimetres(), 1010.0);
}

TEST(ScanColumns, TellWhenTheFirstSampleWasTakenOnBothClocks) {
    auto captured = sweep_of({sample(0, 4, 1000), sample(0, 4, 1500)});
    captured.monotonic_to_unix = 1'700'000'000s;
    const auto scan = columns_of(captured);
    EXPECT_EQ(scan.first_monotonic_ns(), 1'000'000U);
    EXPECT_EQ(scan.first_unix_ns(), 1'700'000'000'001'000'000U);
}

TEST(ScanColumns, CountTimesFromTheEarliestSampleWhicheverItIs) {
    auto captured = sweep_of({sample(0, 4, 1500), sample(0, 4, 1000), sample(0, 4, 1300)});
    captured.monotonic_to_unix = 5s;
    const auto scan = columns_of(captured);
    EXPECT_EQ(scan.first_monotonic_ns(), 1'000'000U);
    EXPECT_EQ(scan.first_unix_ns(), 5'001'000'000U);
    EXPECT_GE(scan.time_step_ps(0), 500'000'000);
    EXPECT_EQ(there_and_back(captured), captured.sweep.samples);
}

TEST(ScanColumns, TellNoWallClockTimeThatCannotBe) {
    EXPECT_EQ(columns_of(sweep_of({sample(0, 4, -1)})).first_unix_ns(), 0U);
    auto captured = sweep_of({sample(0, 4, 5)});
    captured.monotonic_to_unix = std::chrono::nanoseconds::max();
    EXPECT_EQ(columns_of(captured).first_unix_ns(), 0U);
}

TEST(ScanColumns, KeepWhatIsKnownOfTheSweep) {
    auto captured = sweep_of({sample(0, 4, 1000)});
    captured.sweep.period = 100ms;
    captured.sweep.losses = {1, 2, 3, 4};
    captured.mode = "Boost";
    captured.answer_type = protocol::AnswerType::ultra;
    captured.monotonic_to_unix = 5s;
    const auto decoded = from_columns(columns_of(captured)).value();
    EXPECT_EQ(decoded.sweep, captured.sweep);
    EXPECT_EQ(decoded.mode, "Boost");
    EXPECT_EQ(decoded.answer_type, protocol::AnswerType::ultra);
    EXPECT_EQ(decoded.first_unix, 5'001'000'000ns);
}

TEST(ScanColumns, BringAPeriodIntoTheRangeOfItsField) {
    auto captured = sweep_of({});
    captured.sweep.period = -1us;
    EXPECT_EQ(columns_of(captured).period_us(), 0U);
    captured.sweep.period = std::chrono::microseconds::max();
    EXPECT_EQ(columns_of(captured).period_us(), std::numeric_limits<std::uint32_t>::max());
}

TEST(ScanColumns, AreReadableWhateverADeviceCallsItsMode) {
    auto captured = sweep_of({});
    captured.mode = "Fa\xff\x1bst";
    v1::Scan parsed;
    ASSERT_TRUE(parsed.ParseFromString(columns_of(captured).SerializeAsString()));
    EXPECT_EQ(parsed.mode(), "Fa\\xff\\u001bst");
}

TEST(ScanColumns, BringBackEveryAngle) {
    for (const std::uint32_t stride : {1U, 256U, 32767U, 32768U, 40000U}) {
        std::vector<Sample> samples;
        for (std::uint32_t i = 0; i < max_samples; ++i) {
            samples.push_back(sample(static_cast<std::uint16_t>(i * stride), 4));
        }
        const auto captured = sweep_of(samples);
        EXPECT_EQ(there_and_back(captured), captured.sweep.samples) << stride;
    }
}

TEST(ScanColumns, BringBackTheLimitsOfEveryField) {
    constexpr auto latest = farthest_us / 2;
    auto captured = sweep_of(
        {sample(0, 0xFFFFFFFF, latest),
         sample(65535, 1, -latest),
         sample(32768, 0, latest),
         sample(32767, 0xFFFFFFFC, -1)}
    );
    captured.sweep.samples[0].flag = 255;
    captured.sweep.samples[1].quality = 255;
    captured.sweep.samples[2].quality = 255;
    EXPECT_EQ(there_and_back(captured), captured.sweep.samples);
}

TEST(ScanColumns, BringBackThousandsOfRandomSweeps) {
    std::mt19937_64 random(20251122);  // NOLINT(cert-msc51-cpp): the same sweeps in every run
    v1::Scan scan;
    for (int i = 0; i < 5000; ++i) {
        const auto captured = random_sweep(random);
        to_columns(whole_sweep(captured), {}, scan);
        v1::Scan parsed;
        ASSERT_TRUE(parsed.ParseFromString(scan.SerializeAsString()));
        const auto decoded = from_columns(parsed);
        ASSERT_TRUE(decoded.has_value()) << i << ": " << decoded.error().message();
        ASSERT_EQ(decoded->sweep, captured.sweep) << i;
        ASSERT_EQ(decoded->answer_type, captured.answer_type) << i;
    }
}

TEST(ScanColumns, RefuseASweepBeyondAnySize) {
    v1::Scan scan;
    EXPECT_THROW(
        to_columns(whole_sweep(sweep_of(std::vector<Sample>(max_samples + 1))), {}, scan),
        std::length_error
    );
}

}  // namespace
}  // namespace sweepcast::frame
