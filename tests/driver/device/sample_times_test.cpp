// The times that a ScanReader gives, against the moments at which a virtual lidar measured.
#include "tests/support/time_errors.hpp"

#include <gtest/gtest.h>

#include <string>

namespace sweepcast::device {
namespace {

using namespace std::chrono_literals;
using protocol::AnswerType;
using test::LineModel;
using test::LineScan;

struct Stream {
    const char* key;
    AnswerType type;
    /// What may be left of the error of bursts, by the time between two packets on the line.
    double burst_p99_us;
};

class SampleTimesTest : public testing::TestWithParam<Stream> {
protected:
    static constexpr auto length = 5s;

    static test::TimeErrors errors_of(const LineModel& model) {
        const auto type = GetParam().type;
        const LineScan scan(GetParam().key, type, model, length);
        const auto sweeps = test::as_read(scan, type);
        EXPECT_GT(sweeps.size(), 20U);
        const auto errors = test::time_errors(scan, sweeps);
        EXPECT_EQ(errors.back, 0U) << "times go back";
        return errors;
    }
};

TEST_P(SampleTimesTest, AreExactOnALineThatDelaysNothing) {
    const auto errors = errors_of({});
    EXPECT_LE(errors.greatest_us, 10.0);
    EXPECT_LE(errors.stated_us, 30.0);
    EXPECT_EQ(errors.within, 1.0);
}

TEST_P(SampleTimesTest, DoNotJitterAsTheLineDoes) {
    const auto errors = errors_of({.jitter = 300us});
    EXPECT_LE(errors.median_us, 10.0);
    EXPECT_LE(errors.p99_us, 120.0);
    EXPECT_EQ(errors.within, 1.0);
}

TEST_P(SampleTimesTest, DoNotComeInBurstsAsTheBytesDo) {
    const auto errors = errors_of({.poll = 16ms, .jitter = 100us, .crystal_ppm = 100});
    EXPECT_LE(errors.p99_us, GetParam().burst_p99_us);
    EXPECT_GE(errors.within, 0.99);
}

TEST_P(SampleTimesTest, AreAsUncertainAsTheySayWhereTheReaderPolls) {
    for (const auto poll : {1ms, 16ms}) {
        for (const auto crystal_ppm : {-200.0, 8000.0}) {
            const auto errors =
                errors_of({.poll = poll, .jitter = 50us, .crystal_ppm = crystal_ppm});
            EXPECT_GE(errors.within, 0.99) << poll.count() << " ms, " << crystal_ppm << " ppm";
        }
    }
}

TEST_P(SampleTimesTest, AreAsUncertainAsTheySayWhereBytesAreDamaged) {
    const auto errors = errors_of({.poll = 16ms, .jitter = 100us, .damaged = 0.01});
    EXPECT_GE(errors.within, 0.97);  // noise that passes for a sample of 0x81 tells a wrong truth
}

TEST_P(SampleTimesTest, GoOnRightAfterAPause) {
    const auto errors = errors_of({.poll = 4ms, .jitter = 100us, .pause = 700ms});
    EXPECT_LE(errors.p99_us, GetParam().burst_p99_us);
    EXPECT_GE(errors.within, 0.95);
}

INSTANTIATE_TEST_SUITE_P(
    Streams,
    SampleTimesTest,
    testing::Values(
        Stream{"a1m8", AnswerType::normal, 300},
        Stream{"s2", AnswerType::normal, 150},
        Stream{"a1m8", AnswerType::express, 900},
        Stream{"s3", AnswerType::hq, 4300},
        Stream{"a2m12", AnswerType::ultra, 1000},
        Stream{"s2", AnswerType::dense, 900},
        Stream{"c1", AnswerType::ultra_dense, 11000}
    ),
    [](const auto& stream) {
        return std::string(stream.param.key) + "_" +
               std::to_string(static_cast<unsigned>(stream.param.type));
    }
);

TEST(SampleTimes, SurviveTheLossOfPackets) {
    for (const auto type : {AnswerType::dense, AnswerType::normal}) {
        const LineScan scan("s2", type, {.poll = 16ms, .jitter = 100us, .lost = 0.002}, 5s);
        const auto errors = test::time_errors(scan, test::as_read(scan, type));
        EXPECT_EQ(errors.back, 0U);
        EXPECT_LE(errors.p99_us, 1500.0);
        EXPECT_GE(errors.within, 0.9);
    }
}

}  // namespace
}  // namespace sweepcast::device
