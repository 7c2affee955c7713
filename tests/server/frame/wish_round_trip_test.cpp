// Wishes through frames: what a client decodes is what its wish makes of the sweep.
#include "server/frame/angle_units.hpp"
#include "server/frame/apply_wish.hpp"
#include "server/frame/frame_decoder.hpp"
#include "server/frame/frame_encoder.hpp"
#include "sweepcast/v1/stream.pb.h"
#include "tests/server/frame/random_sweep.hpp"
#include "tests/server/frame/random_wish.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace sweepcast::frame {
namespace {

using protocol::Sample;
using Samples = std::vector<Sample>;

class WishRoundTripTest : public testing::Test {
protected:
    /// What a client gets of a sweep.
    DecodedScan through_a_frame(const device::CapturedSweep& captured, const Wish& wish) {
        auto content = whole_sweep(captured);
        content.samples = apply_wish(wish, content.samples, 0, memory);
        const auto wire = encoder.encode(content, wish.format);
        v1::ServerMessage message;
        const auto bytes = wire->message();
        EXPECT_TRUE(message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
        return decoder.decode(message.frame()).value();
    }

    /// Fails unless `got` is `expected` as far as the format lets it through.
    static void
    expect_same(const Samples& got, const Samples& expected, const FrameFormat& format) {
        ASSERT_EQ(got.size(), expected.size());
        for (std::size_t i = 0; i < got.size(); ++i) {
            expect_same(got[i], expected[i], format);
        }
    }

    static void expect_same(const Sample& got, const Sample& expected, const FrameFormat& format) {
        ASSERT_EQ(got.distance.has_echo(), expected.distance.has_echo());
        if (format.distance_unit_um == 0) {
            ASSERT_EQ(got.distance, expected.distance);
        } else if (expected.distance.has_echo()) {
            // Half a unit, a unit for an echo nearer than that, and half of 0.25 mm.
            const double most = std::max(
                0.5 * format.distance_unit_um,
                format.distance_unit_um - 250.0 * expected.distance.raw
            );
            const double off = 250.0 * got.distance.raw - 250.0 * expected.distance.raw;
            ASSERT_LE(std::abs(off), most + 125);
        }
        if (format.angle_units_per_turn == 0) {
            ASSERT_EQ(got.angle, expected.angle);
        } else {
            const auto off = static_cast<std::int16_t>(got.angle.raw - expected.angle.raw);
            ASSERT_LE(std::abs(off), 32768.0 / format.angle_units_per_turn + 1);
        }
        if (!format.leave_out_quality) {
            ASSERT_EQ(got.quality, expected.quality);
        }
        if (!format.leave_out_flags) {
            ASSERT_EQ(got.flag, expected.flag);
        }
        if (!format.leave_out_times) {
            ASSERT_EQ(got.time, expected.time);
        }
    }

    FrameEncoder encoder;
    FrameDecoder decoder;
    Samples memory;
};

TEST_F(WishRoundTripTest, RandomSweepsComeAsWished) {
    std::mt19937_64 random(20251201);  // NOLINT(cert-msc51-cpp): the same in every run
    for (int i = 0; i < 1000; ++i) {
        const auto captured = random_sweep(random);
        const auto wish = random_wish(Kind::sweep, random);
        const auto decoded = through_a_frame(captured, wish);
        Samples room;
        const auto expected = apply_wish(wish, captured.sweep.samples, 0, room);
        expect_same(decoded.sweep.samples, {expected.begin(), expected.end()}, wish.format);
        ASSERT_FALSE(HasFatalFailure()) << "in case " << i;
        ASSERT_EQ(decoded.sweep.period, captured.sweep.period);
    }
}

TEST_F(WishRoundTripTest, RecordedSweepsComeAsWished) {
    std::mt19937_64 random(3);  // NOLINT(cert-msc51-cpp): the same in every run
    for (const auto& name : recorded_streams()) {
        for (auto& event : read_stream(name, random).events) {
            if (!event.complete) {
                continue;
            }
            device::CapturedSweep captured;
            captured.sweep = event.sweep;
            const auto wish = random_wish(Kind::sweep, random);
            const auto decoded = through_a_frame(captured, wish);
            Samples room;
            const auto expected = apply_wish(wish, captured.sweep.samples, 0, room);
            expect_same(decoded.sweep.samples, {expected.begin(), expected.end()}, wish.format);
            ASSERT_FALSE(HasFatalFailure()) << name;
        }
    }
}

TEST_F(WishRoundTripTest, TheMiddlesOfBinsAreExact) {
    std::mt19937_64 random(8);  // NOLINT(cert-msc51-cpp): the same in every run
    const auto captured = sweep_of_a_room({.samples = 800}, random);
    for (const std::uint32_t count : {1U, 90U, 720U, 1000U, 11520U, 16384U}) {
        Wish wish;
        wish.bins.count = count;
        wish.format.angle_units_per_turn = 2 * count;
        const auto decoded = through_a_frame(captured, wish);
        ASSERT_EQ(decoded.sweep.samples.size(), count);
        for (std::uint32_t bin = 0; bin < count; ++bin) {
            const auto& sample = decoded.sweep.samples[bin];
            ASSERT_EQ(to_units(sample.angle, 2 * count), 2 * bin + 1);
            if (2 * count != q6_per_turn) {  // in which degrees() gives the vendor's value
                ASSERT_DOUBLE_EQ(decoded.degrees(sample), (bin + 0.5) * 360 / count);
            }
        }
    }
}

TEST_F(WishRoundTripTest, NoBinIsEarlierThanTheScan) {
    std::mt19937_64 random(10);  // NOLINT(cert-msc51-cpp): the same in every run
    for (int i = 0; i < 50; ++i) {
        auto captured = sweep_of_a_room({.samples = 800}, random);
        captured.monotonic_to_unix = std::chrono::hours(1);
        auto& samples = captured.sweep.samples;
        for (auto& sample : samples) {  // as of a lidar that begins its revolution elsewhere
            sample.angle.raw = static_cast<std::uint16_t>(sample.angle.raw + 1000);
        }
        Wish wish;
        wish.bins.count = 360;
        wish.format.angle_units_per_turn = 720;
        const auto decoded = through_a_frame(captured, wish);
        const auto& got = decoded.sweep.samples;
        ASSERT_EQ(decoded.first_time, std::ranges::min_element(got, {}, &Sample::time)->time);
        for (const auto& sample : got) {
            ASSERT_EQ(
                decoded.unix_time(sample),
                sample.time.time_since_epoch() + std::chrono::hours(1)
            );
        }
    }
}

}  // namespace
}  // namespace sweepcast::frame
