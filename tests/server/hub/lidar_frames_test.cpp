// LidarFrames: one lidar's sweeps and sectors, as often as they are wanted and no oftener.
#include "server/hub/lidar_frames.hpp"

#include "server/frame/apply_wish.hpp"
#include "server/frame/frame_decoder.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace sweepcast::hub {
namespace {

using namespace std::chrono_literals;
using protocol::Sample;
using Samples = std::vector<Sample>;

v1::Frame frame_in(const VariantFrame& made) {
    v1::ServerMessage message;
    const auto bytes = made.message->message();
    EXPECT_TRUE(message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
    return message.frame();
}

class LidarFramesTest : public testing::Test {
protected:
    /// Turns of 10 Hz, a sample each degree.
    static device::CapturedSweep sweep(std::uint64_t sequence) {
        device::CapturedSweep captured;
        for (int i = 0; i < 360; ++i) {
            Sample sample;
            sample.time =
                protocol::SampleTime(std::chrono::milliseconds(100 * sequence) + i * 100ms / 360);
            sample.angle.raw = static_cast<std::uint16_t>((i * 65536 + 359) / 360);
            sample.distance.raw = static_cast<std::uint32_t>(4000 + 4 * i);
            sample.quality = 188;
            captured.sweep.samples.push_back(sample);
        }
        captured.sweep.period = 100ms;
        captured.sweep.losses.checksum_errors = 3;
        captured.sweep.begun = sequence;
        captured.lidar = "A0E1C2D3";
        captured.lidar_number = 1;
        captured.sequence = sequence;
        return captured;
    }

    /// The sweep under way, read so far.
    static device::SweepProgress progress(const device::CapturedSweep& captured, std::size_t end) {
        device::SweepProgress progress;
        progress.sweep = {std::span(captured.sweep.samples).first(end), captured.sweep.begun};
        progress.sequence = captured.sequence;
        progress.arrival = captured.sweep.samples[end - 1].time;
        return progress;
    }

    /// Everything that is made of a sweep read in pieces of this many samples.
    std::vector<VariantFrame> read(const device::CapturedSweep& captured, std::size_t piece) {
        std::vector<VariantFrame> all;
        for (std::size_t end = piece; end < captured.sweep.samples.size(); end += piece) {
            for (auto& made : frames.of("A0E1C2D3", progress(captured, end))) {
                all.push_back(std::move(made));
            }
        }
        for (auto& made : frames.of(captured)) {
            all.push_back(std::move(made));
        }
        return all;
    }

    static Wish sectors_of(std::uint32_t mdeg) {
        Wish wish;
        wish.frames.kind = frame::Kind::sector;
        wish.frames.sector_mdeg = mdeg;
        return wish;
    }

    Variants variants;
    LidarFrames frames{variants, 1};
    frame::FrameDecoder decoder;
};

TEST_F(LidarFramesTest, NothingIsMadeWhileNobodyWantsIt) {
    EXPECT_TRUE(read(sweep(1), 10).empty());
    const auto of_another = variants.acquire(Wish{.lidar = 2, .frames = {}});
    EXPECT_TRUE(read(sweep(2), 10).empty());
    const auto wanted = variants.acquire(Wish{});
    EXPECT_EQ(read(sweep(3), 10).size(), 1U);
    variants.release(wanted, std::nullopt);
    EXPECT_TRUE(read(sweep(4), 10).empty());
}

TEST_F(LidarFramesTest, EveryVariantIsMadeOnce) {
    Wish thin;
    thin.frames.every_nth = 2;
    const auto whole = variants.acquire(Wish{});
    const auto half = variants.acquire(thin);
    (void)variants.acquire(thin);
    const auto made = frames.of(sweep(1));
    ASSERT_EQ(made.size(), 2U);
    EXPECT_EQ(made[0].variant, whole);
    EXPECT_EQ(made[1].variant, half);
    EXPECT_EQ(decoder.decode(frame_in(made[0]))->sweep.samples.size(), 360U);
    EXPECT_EQ(decoder.decode(frame_in(made[1]))->sweep.samples.size(), 180U);
}

TEST_F(LidarFramesTest, SectorsAreNumberedAndTheLastTellsOfTheSweep) {
    (void)variants.acquire(sectors_of(90'000));
    const auto captured = sweep(5);
    const auto made = read(captured, 7);
    ASSERT_EQ(made.size(), 4U);
    Samples joined;
    for (std::size_t i = 0; i < made.size(); ++i) {
        const auto frame = frame_in(made[i]);
        EXPECT_EQ(frame.kind(), v1::SECTOR);
        EXPECT_EQ(frame.lidar(), "A0E1C2D3");
        EXPECT_EQ(frame.sequence(), 5U);
        EXPECT_EQ(frame.sector(), i);
        EXPECT_EQ(frame.last(), i == 3);
        const auto decoded = decoder.decode(frame).value();
        EXPECT_EQ(decoded.sweep.period, i == 3 ? 100ms : 0ms);
        EXPECT_EQ(decoded.sweep.losses.checksum_errors, i == 3 ? 3U : 0U);
        joined.insert(joined.end(), decoded.sweep.samples.begin(), decoded.sweep.samples.end());
    }
    EXPECT_EQ(joined, captured.sweep.samples);
}

TEST_F(LidarFramesTest, SectorsWithoutSamplesAreNotSentButTheLastIs) {
    auto wish = sectors_of(30'000);
    const std::vector<frame::AngleWindow> ahead{{100, 170}};
    wish.frames.angles = frame::AngleSet(ahead, {});
    (void)variants.acquire(wish);
    const auto made = read(sweep(1), 10);
    std::size_t samples = 0;
    for (std::size_t i = 0; i < made.size(); ++i) {
        EXPECT_EQ(frame_in(made[i]).sector(), i);
        samples += decoder.decode(frame_in(made[i]))->sweep.samples.size();
    }
    EXPECT_EQ(made.size(), 4U);
    EXPECT_EQ(samples, 70U);
    EXPECT_TRUE(frame_in(made.back()).last());
}

TEST_F(LidarFramesTest, ASweepGivenUpBeginsAgainWithSectorZero) {
    (void)variants.acquire(sectors_of(90'000));
    auto given_up = sweep(3);
    EXPECT_EQ(frame_in(frames.of("x", progress(given_up, 95)).at(0)).sector(), 0U);
    EXPECT_EQ(frame_in(frames.of("x", progress(given_up, 185)).at(0)).sector(), 1U);
    auto anew = sweep(3);
    anew.sweep.begun = 4;
    EXPECT_TRUE(frames.of("x", progress(anew, 20)).empty());
    const auto first = frame_in(frames.of("x", progress(anew, 95)).at(0));
    EXPECT_EQ(first.sector(), 0U);
    EXPECT_EQ(first.sequence(), 3U);
    EXPECT_EQ(decoder.decode(first)->sweep.samples.size(), 95U);
}

TEST_F(LidarFramesTest, OneWhoComesInTheMiddleOfASweepGetsAllOfIt) {
    const auto captured = sweep(1);
    EXPECT_TRUE(frames.of("x", progress(captured, 200)).empty());
    (void)variants.acquire(sectors_of(90'000));
    const auto made = frames.of("x", progress(captured, 210));
    ASSERT_EQ(made.size(), 1U);
    EXPECT_EQ(decoder.decode(frame_in(made[0]))->sweep.samples.size(), 210U);
}

TEST_F(LidarFramesTest, ARateLimitTellsWhatItLeftOut) {
    Wish slow;
    slow.frames.least_interval = 300ms;
    (void)variants.acquire(slow);
    std::uint64_t before = 0;
    int sent = 0;
    for (std::uint64_t sequence = 1; sequence <= 20; ++sequence) {
        const auto made = frames.of(sweep(sequence));
        ASSERT_EQ(made.size(), 1U);
        const auto frame = frame_in(made[0]);
        if (!made[0].is_new) {
            EXPECT_EQ(frame.sequence(), before);  // for who comes late
            continue;
        }
        EXPECT_EQ(frame.sequence(), sequence);
        EXPECT_EQ(frame.omitted(), sequence - before - 1);
        before = sequence;
        ++sent;
    }
    EXPECT_EQ(sent, 7);
}

TEST_F(LidarFramesTest, ABelatedFrameIsMadeOnceForASweep) {
    const auto variant = variants.acquire(Wish{});
    frame::WishEncoder here;
    frame::WishEncoder elsewhere;
    const auto made = variant->belated_frame(sweep(1), here);
    EXPECT_EQ(variant->belated_frame(sweep(1), elsewhere), made);
    EXPECT_NE(variant->belated_frame(sweep(2), here), made);
    const auto published = frames.of(sweep(1)).at(0).message->message();
    const auto belated = made->message();
    EXPECT_TRUE(std::ranges::equal(published, belated));
}

}  // namespace
}  // namespace sweepcast::hub
