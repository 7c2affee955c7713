// What `sweepcast watch` prints of a scan, as CSV and as JSON.
#include "server/cli/watch_output.hpp"

#include "server/frame/apply_wish.hpp"
#include "server/frame/frame_content.hpp"
#include "server/frame/scan_columns.hpp"
#include "sweepcast/v1/api.pb.h"
#include "sweepcast/v1/scan.pb.h"

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

namespace sweepcast::cli {
namespace {

using namespace std::chrono_literals;
using protocol::Sample;
using protocol::SampleTime;

/// A sweep that begins at 10 degrees, as the lidar measured it: 0.1 ms from sample to sample.
const std::vector<Sample> measured{
    {SampleTime(1'000'000us), {4000}, {1820}, 188, 1},
    {SampleTime(1'000'100us), {4004}, {32768}, 188, 2},
    {SampleTime(1'000'200us), {4008}, {91}, 188, 2},
};

/// What a client gets that asked for `wish`.
client::Scan received(const frame::Wish& wish, std::chrono::nanoseconds to_unix = 1'700'000'000s) {
    std::vector<Sample> memory;
    frame::FrameContent content;
    content.sample_duration = 50us;
    content.monotonic_to_unix = to_unix;
    content.samples = frame::apply_wish(wish, measured, 0, memory);
    v1::Scan columns;
    frame::to_columns(content, wish.format, columns);
    client::Scan scan;
    scan.lidar = "A";
    scan.sequence = 7;
    scan.scan = frame::from_columns(columns).value();
    return scan;
}

frame::Wish bins(std::uint32_t count) {
    frame::Wish wish;
    wish.bins.count = count;
    wish.format.angle_units_per_turn = 2 * count;
    return wish;
}

std::string printed(WatchOutput& output, const client::Scan& scan) {
    testing::internal::CaptureStdout();
    output.on_scan(scan);
    return testing::internal::GetCapturedStdout();
}

std::string csv(const client::Scan& scan) {
    return printed(*make_csv_output(false), scan);
}

v1::LatestScan json(const client::Scan& scan) {
    v1::LatestScan message;
    const auto text = printed(*make_json_output(), scan);
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(text, &message).ok()) << text;
    return message;
}

constexpr auto header = "lidar,sequence,unix_ns,angle_deg,distance_mm,quality,flag\n";

TEST(WatchOutput, CsvHasALinePerSample) {
    EXPECT_EQ(
        csv(received({})),
        header + std::string("A,7,1700000001000000000,9.9976,1000.00,188,1\n"
                             "A,7,1700000001000100000,180.0000,1001.00,188,2\n"
                             "A,7,1700000001000200000,0.4999,1002.00,188,2\n")
    );
}

TEST(WatchOutput, ColumnsThatWereLeftOutAreEmptyInCsv) {
    frame::Wish wish;
    wish.every_nth = 2;
    wish.format.leave_out_times = true;
    wish.format.leave_out_quality = true;
    wish.format.leave_out_flags = true;
    EXPECT_EQ(
        csv(received(wish)),
        header + std::string("A,7,,9.9976,1000.00,,\nA,7,,0.4999,1002.00,,\n")
    );
}

TEST(WatchOutput, ColumnsThatWereLeftOutAreEmptyInJson) {
    frame::Wish wish;
    wish.every_nth = 2;
    wish.format.leave_out_times = true;
    wish.format.leave_out_quality = true;
    const auto scan = json(received(wish));
    EXPECT_EQ(scan.time().seconds(), 1'700'000'001) << "the first sample's is known";
    EXPECT_EQ(scan.angle_deg_size(), 2);
    EXPECT_EQ(scan.time_us_size(), 0);
    EXPECT_EQ(scan.quality_size(), 0);
}

TEST(WatchOutput, AWallClockTimeThatIsNotKnownIsNotPrinted) {
    const auto scan = received({}, -2s);
    EXPECT_FALSE(json(scan).has_time());
    EXPECT_EQ(json(scan).time_us_size(), 3);
    EXPECT_EQ(csv(scan).find("A,7,,9.9976,"), std::string(header).size());
}

TEST(WatchOutput, TheMiddlesOfBinsAreExact) {
    const auto scan = json(received(bins(360)));
    ASSERT_EQ(scan.angle_deg_size(), 360);
    for (int bin = 0; bin < 360; ++bin) {
        EXPECT_EQ(scan.angle_deg(bin), bin + 0.5);
    }
    EXPECT_NE(csv(received(bins(360))).find(",0.5000,1002.00,"), std::string::npos);
}

TEST(WatchOutput, TheTimesOfBinsCountFromTheEarliest) {
    const auto scan = json(received(bins(360)));
    EXPECT_EQ(scan.time().seconds(), 1'700'000'001);
    EXPECT_EQ(scan.time().nanos(), 0);
    ASSERT_EQ(scan.time_us_size(), 360);
    EXPECT_EQ(scan.time_us(9), 0);
    EXPECT_EQ(scan.time_us(180), 100);
    EXPECT_EQ(scan.time_us(0), 200);
    EXPECT_NE(csv(received(bins(360))).find("A,7,1700000001000200000,0.5000,"), std::string::npos);
}

}  // namespace
}  // namespace sweepcast::cli
