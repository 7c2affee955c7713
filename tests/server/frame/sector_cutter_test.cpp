// SectorCutter: where sweeps are cut, and that nothing is lost or told twice.
#include "server/frame/sector_cutter.hpp"

#include "tests/server/frame/random_wish.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace sweepcast::frame {
namespace {

using namespace std::chrono_literals;
using protocol::Sample;

Wish by_angle(std::uint32_t mdeg) {
    Wish wish;
    wish.kind = Kind::sector;
    wish.sector_mdeg = mdeg;
    return wish;
}

Wish by_time(std::chrono::microseconds latency) {
    Wish wish;
    wish.kind = Kind::sector;
    wish.max_latency = latency;
    return wish;
}

/// A turn of 10 Hz from 0 degrees on, a sample each degree; read as the test says.
class SectorCutterTest : public testing::Test {
protected:
    SectorCutterTest() {
        for (int i = 0; i < 360; ++i) {
            Sample sample;
            sample.time = start + i * 100ms / 360;
            sample.angle.raw = static_cast<std::uint16_t>((i * 65536 + 359) / 360);
            captured.sweep.samples.push_back(sample);
        }
        captured.sweep.begun = 7;
    }

    /// The samples below number `end` have been read, the last just now.
    std::optional<Slice> read(SectorCutter& cutter, std::size_t end) {
        device::SweepProgress progress;
        progress.sweep = {std::span(captured.sweep.samples).first(end), captured.sweep.begun};
        progress.arrival = captured.sweep.samples[end - 1].time;
        return cutter.cut(progress);
    }

    static constexpr protocol::SampleTime start{1000s};
    device::CapturedSweep captured;
};

TEST_F(SectorCutterTest, CutsAtTheFirstReadBeyondEachMultipleOfTheSize) {
    SectorCutter cutter(by_angle(30'000));
    EXPECT_EQ(read(cutter, 20), std::nullopt);
    EXPECT_EQ(read(cutter, 30), std::nullopt);  // up to 29 degrees
    EXPECT_EQ(read(cutter, 40), (Slice{0, 40, false}));
    EXPECT_EQ(read(cutter, 60), std::nullopt);  // up to 59, and the next cut is due at 60
    EXPECT_EQ(read(cutter, 62), (Slice{40, 62, false}));
    EXPECT_EQ(read(cutter, 200), (Slice{62, 200, false}));
    EXPECT_EQ(read(cutter, 210), std::nullopt);
    EXPECT_EQ(cutter.finish(captured), (Slice{200, 360, true}));
}

TEST_F(SectorCutterTest, ATurnHasAsManySectorsAsFitInto) {
    for (const std::uint32_t degrees : {1U, 7U, 30U, 45U, 100U, 180U, 359U, 360U}) {
        SectorCutter cutter(by_angle(degrees * 1000));
        std::size_t sectors = 1;
        for (std::size_t end = 1; end <= 360; ++end) {
            sectors += read(cutter, end) ? 1U : 0U;
        }
        (void)cutter.finish(captured);
        EXPECT_EQ(sectors, (360 + degrees - 1) / degrees) << degrees;
    }
}

TEST_F(SectorCutterTest, CountsFromTheSweepsOwnBeginning) {
    for (auto& sample : captured.sweep.samples) {
        sample.angle.raw = static_cast<std::uint16_t>(sample.angle.raw + 65000);
    }
    SectorCutter cutter(by_angle(90'000));
    EXPECT_EQ(read(cutter, 89), std::nullopt);
    EXPECT_TRUE(read(cutter, 92));
}

TEST_F(SectorCutterTest, NoiseDoesNotCountAsProgress) {
    captured.sweep.samples[5].angle.raw = 50'000;
    captured.sweep.samples[11].angle.raw = 40'000;
    SectorCutter cutter(by_angle(30'000));
    EXPECT_EQ(read(cutter, 6), std::nullopt);
    EXPECT_EQ(read(cutter, 12), std::nullopt);
    EXPECT_EQ(read(cutter, 29), std::nullopt);
    EXPECT_TRUE(read(cutter, 32));
}

TEST_F(SectorCutterTest, AGapInTheStreamDoes) {
    auto& samples = captured.sweep.samples;
    samples.erase(samples.begin() + 10, samples.begin() + 200);
    SectorCutter cutter(by_angle(90'000));
    EXPECT_EQ(read(cutter, 10), std::nullopt);
    EXPECT_EQ(read(cutter, 12), (Slice{0, 12, false}));
    EXPECT_EQ(read(cutter, 60), std::nullopt);
    EXPECT_EQ(read(cutter, 82), (Slice{12, 82, false}));  // 270 degrees
}

TEST_F(SectorCutterTest, NoSampleWaitsLongerThanItMay) {
    SectorCutter cutter(by_time(20ms));
    (void)read(cutter, 1);  // tells the time between reads from now on
    std::size_t sent = 0;
    for (std::size_t end = 10; end <= 360; end += 9) {
        const auto slice = read(cutter, end);
        const auto now = captured.sweep.samples[end - 1].time;
        if (slice) {
            EXPECT_EQ(slice->begin, sent);
            sent = slice->end;
            EXPECT_LE(now - captured.sweep.samples[slice->begin].time, 20ms);
            EXPECT_GT(now - captured.sweep.samples[slice->begin].time, 15ms);  // but no hurry
        }
    }
    EXPECT_GT(sent, 250U);
}

TEST_F(SectorCutterTest, ALatencyShorterThanAReadMakesEachReadASector) {
    SectorCutter cutter(by_time(1us));
    for (std::size_t end = 10; end <= 350; end += 10) {
        EXPECT_EQ(read(cutter, end), (Slice{end - 10, end, false}));
    }
}

TEST_F(SectorCutterTest, WhatComesFirstEndsTheSector) {
    auto wish = by_angle(30'000);
    wish.max_latency = 5ms;
    SectorCutter cutter(wish);
    EXPECT_EQ(read(cutter, 1), std::nullopt);
    EXPECT_EQ(read(cutter, 9), std::nullopt);
    EXPECT_EQ(read(cutter, 17), (Slice{0, 17, false}));  // 4.4 ms old, the next read would be late
    EXPECT_EQ(read(cutter, 18), std::nullopt);
    EXPECT_EQ(read(cutter, 33), (Slice{17, 33, false}));  // 30 degrees
}

TEST_F(SectorCutterTest, BeginsAnewIfTheSweepWasGivenUp) {
    SectorCutter cutter(by_angle(30'000));
    EXPECT_TRUE(read(cutter, 40));
    captured.sweep.begun = 8;
    EXPECT_EQ(read(cutter, 20), std::nullopt);
    EXPECT_EQ(read(cutter, 31), (Slice{0, 31, false}));
    captured.sweep.begun = 9;  // this one was complete before anything was told of it
    EXPECT_EQ(cutter.finish(captured), (Slice{0, 360, true}));
}

TEST_F(SectorCutterTest, AnswersForASweepThatHasBeenSentWhole) {
    SectorCutter cutter(by_time(1us));
    EXPECT_EQ(read(cutter, 360), (Slice{0, 360, false}));
    EXPECT_EQ(cutter.finish(captured), (Slice{360, 360, true}));
    captured.sweep.begun = 8;
    EXPECT_EQ(cutter.finish(captured), (Slice{0, 360, true}));
}

class RecordedSectorsTest : public testing::TestWithParam<std::string> {};

TEST_P(RecordedSectorsTest, AddUpToTheSweepHoweverItWasRead) {
    std::mt19937_64 random(11);  // NOLINT(cert-msc51-cpp): the same wishes in every run
    std::size_t sweeps = 0;
    for (int round = 0; round < 8; ++round) {
        SectorCutter cutter(random_wish(Kind::sector, random));
        std::vector<Sample> told;
        for (const auto& event : read_stream(GetParam(), random).events) {
            device::SweepProgress progress;
            device::CapturedSweep captured;
            std::optional<Slice> slice;
            if (event.complete) {
                captured.sweep = event.sweep;
                slice = cutter.finish(captured);
            } else {
                progress.sweep = {event.sweep.samples, event.sweep.begun};
                progress.arrival = event.arrival;
                slice = cutter.cut(progress);
            }
            if (!slice) {
                continue;
            }
            if (slice->begin == 0) {
                told.clear();
            }
            ASSERT_EQ(slice->begin, told.size());
            ASSERT_EQ(slice->last, event.complete);
            const auto cut =
                std::span(event.sweep.samples).subspan(slice->begin, slice->end - slice->begin);
            told.insert(told.end(), cut.begin(), cut.end());
            if (slice->last) {
                ASSERT_EQ(told, event.sweep.samples);
                told.clear();
                ++sweeps;
            }
        }
    }
    EXPECT_GE(sweeps, 8U);
}

INSTANTIATE_TEST_SUITE_P(Streams, RecordedSectorsTest, testing::ValuesIn(recorded_streams()));

}  // namespace
}  // namespace sweepcast::frame
