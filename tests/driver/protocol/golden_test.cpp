// Undamaged recorded streams decode bit for bit to what the vendor's decoder gives, however they
// are cut.
#include "tests/driver/protocol/decoding.hpp"
#include "tests/support/vector.hpp"

#include <gtest/gtest.h>

#include <ostream>
#include <string>

namespace sweepcast::protocol {

static void PrintTo(const Sample& sample, std::ostream* out) {
    *out << "{angle " << sample.angle.raw << ", distance " << sample.distance.raw << ", quality "
         << int{sample.quality} << ", flag " << int{sample.flag} << ", time "
         << sample.time.time_since_epoch().count() << "}";
}

static void PrintTo(const DecodeEvent& event, std::ostream* out) {
    *out << "{kind " << static_cast<int>(event.kind) << " at " << event.at_sample << ", count "
         << event.count << "}";
}

namespace {

class GoldenTest : public testing::TestWithParam<std::string> {
protected:
    const test::Vector vector_ = test::load_vector(GetParam());
};

TEST_P(GoldenTest, GivesTheVendorsSamplesAndEvents) {
    const auto decoded = decode_whole(vector_.type, vector_.bytes, vector_.settings);
    EXPECT_EQ(without_times(decoded.samples), without_nonsense(vector_.expected.samples));
    EXPECT_EQ(decoded.events, vector_.expected.events);
}

class AnyVectorTest : public GoldenTest {};

TEST_P(AnyVectorTest, DecodesByteByByteAsWhole) {
    const auto whole = decode_whole(vector_.type, vector_.bytes, vector_.settings);
    const auto bytewise = decode_in_pieces(vector_.type, vector_.settings, vector_.bytes, [] {
        return std::size_t{1};
    });
    EXPECT_EQ(bytewise.samples, whole.samples);
    EXPECT_EQ(bytewise.events, whole.events);
}

TEST_P(AnyVectorTest, DecodesCutAnywhereAsWhole) {
    const auto whole = decode_whole(vector_.type, vector_.bytes, vector_.settings);
    for (unsigned seed = 1; seed <= 20; ++seed) {
        std::mt19937 random(seed);
        std::uniform_int_distribution<std::size_t> size(1, 50 * seed);
        const auto cut = decode_in_pieces(vector_.type, vector_.settings, vector_.bytes, [&] {
            return size(random);
        });
        ASSERT_EQ(cut.samples, whole.samples) << "seed " << seed;
        ASSERT_EQ(cut.events, whole.events) << "seed " << seed;
    }
}

/// The vendor's times, corrected where they are not those of the packet that held the sample
/// (protocol.md 8): those of dense types are one packet late, one packet being handed over at a
/// time; those of HQ are the last sample's for all.
std::vector<SampleTime> corrected_times(const test::Vector& vector) {
    const auto& timing = vector.timing.value();
    auto times = timing.sample_times;
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (vector.type == AnswerType::dense || vector.type == AnswerType::ultra_dense) {
            times[i] -= timing.between_chunks;
        }
        if (vector.type == AnswerType::hq) {
            const auto samples_later = static_cast<int>(95 - i % 96);
            times[i] -= samples_later * std::chrono::duration_cast<std::chrono::microseconds>(
                                            vector.settings.sample_duration
                                        );
        }
    }
    return times;
}

class GoldenTimingTest : public GoldenTest {};

TEST_P(GoldenTimingTest, GivesTheVendorsTimesForThePacketThatHeldTheSample) {
    const auto& timing = vector_.timing.value();
    auto decoder = make_decoder(vector_.type, timing.settings);
    Decoded decoded;
    auto now = timing.first_chunk;
    for (std::span<const std::uint8_t> rest(vector_.bytes); !rest.empty();) {
        const auto chunk = rest.first(std::min(timing.chunk_bytes, rest.size()));
        decoder.push(chunk, {now, {}}, decoded);
        rest = rest.subspan(chunk.size());
        now += timing.between_chunks;
    }
    std::vector<SampleTime> times;
    for (const auto& sample : decoded.samples) {
        times.push_back(sample.time);
    }
    EXPECT_EQ(timing.chunk_bytes % packet_size(vector_.type), 0U);
    EXPECT_EQ(times, corrected_times(vector_));
}

constexpr auto name_of = [](const auto& tested) { return "v" + tested.param; };

INSTANTIATE_TEST_SUITE_P(
    Clean,
    GoldenTest,
    testing::Values(
        "81_extremes",
        "81_room",
        "81_speed",
        "81_timing",
        "82_border",
        "82_extremes",
        "82_room",
        "82_speed",
        "82_timing",
        "83_extremes",
        "83_room",
        "83_speed",
        "83_timing",
        "84_bands",
        "84_border",
        "84_extremes",
        "84_room",
        "84_speed",
        "84_timing",
        "85_border",
        "85_extremes",
        "85_room",
        "85_speed",
        "85_timing",
        "86_bands",
        "86_border",
        "86_extremes",
        "86_room",
        "86_speed",
        "86_timing"
    ),
    name_of
);
INSTANTIATE_TEST_SUITE_P(
    All,
    AnyVectorTest,
    testing::Values(
        "81_damage",
        "81_extremes",
        "81_fuzz",
        "81_room",
        "81_speed",
        "81_timing",
        "82_border",
        "82_damage",
        "82_extremes",
        "82_fuzz",
        "82_room",
        "82_speed",
        "82_timing",
        "83_damage",
        "83_extremes",
        "83_fuzz",
        "83_room",
        "83_speed",
        "83_timing",
        "84_bands",
        "84_border",
        "84_damage",
        "84_extremes",
        "84_fuzz",
        "84_room",
        "84_speed",
        "84_timing",
        "85_border",
        "85_damage",
        "85_extremes",
        "85_fuzz",
        "85_room",
        "85_speed",
        "85_timing",
        "86_bands",
        "86_border",
        "86_damage",
        "86_extremes",
        "86_fuzz",
        "86_room",
        "86_speed",
        "86_timing"
    ),
    name_of
);
INSTANTIATE_TEST_SUITE_P(
    Timed,
    GoldenTimingTest,
    testing::Values("81_timing", "82_timing", "83_timing", "84_timing", "85_timing", "86_timing"),
    name_of
);

}  // namespace
}  // namespace sweepcast::protocol
