// Ramps: that the angles of whatever lidars send come back, and that capsules cost few numbers.
#include "server/frame/angle_ramps.hpp"

#include "driver/protocol/decode.hpp"
#include "server/frame/frame_content.hpp"
#include "server/frame/scan_columns.hpp"
#include "sweepcast/v1/scan.pb.h"
#include "tests/support/vector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace sweepcast::frame {
namespace {

using protocol::AnswerType;
using protocol::Sample;

std::vector<Sample> decode(const test::Vector& vector) {
    auto decoder = protocol::Decoder::create(vector.type, vector.settings).value();
    protocol::Decoded decoded;
    decoder.push(vector.bytes, {}, decoded);
    return decoded.samples;
}

v1::Scan columns_of(std::span<const Sample> samples, AnswerType type) {
    FrameContent content;
    content.samples = samples;
    content.answer_type = type;
    v1::Scan scan;
    to_columns(content, {}, scan);
    return scan;
}

class RampsOfVectorTest : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(
    Vectors,
    RampsOfVectorTest,
    testing::Values(
        "81_room",
        "81_damage",
        "82_room",
        "82_border",
        "82_damage",
        "82_extremes",
        "82_fuzz",
        "82_speed",
        "83_room",
        "83_damage",
        "84_room",
        "84_bands",
        "84_border",
        "84_damage",
        "84_extremes",
        "84_fuzz",
        "84_speed",
        "85_room",
        "85_border",
        "85_damage",
        "85_extremes",
        "85_fuzz",
        "85_speed",
        "86_room",
        "86_damage",
        "86_extremes",
        "86_fuzz",
        "86_speed"
    ),
    [](const auto& test) { return "answers_" + test.param; }
);

TEST_P(RampsOfVectorTest, BringBackEverySliceOfWhatWasDecoded) {
    const auto vector = test::load_vector(GetParam());
    const auto samples = decode(vector);
    std::mt19937_64 random(1);  // NOLINT(cert-msc51-cpp): the same slices in every run
    for (int i = 0; i < 60; ++i) {
        const std::size_t first = random() % (samples.size() + 1);
        const auto most = std::min<std::size_t>(samples.size() - first, i % 3 == 0 ? 100 : 4000);
        const auto slice = std::span(samples).subspan(first, random() % (most + 1));
        const auto decoded = from_columns(columns_of(slice, vector.type));
        ASSERT_TRUE(decoded.has_value()) << decoded.error().message();
        ASSERT_TRUE(std::equal(
            slice.begin(),
            slice.end(),
            decoded->sweep.samples.begin(),
            decoded->sweep.samples.end()
        )) << first
           << " " << slice.size();
    }
}

struct CleanStream {
    std::string vector;
    std::uint32_t length{};
    bool parallax{};
    bool corrections{};
};

class RampsOfCleanStreamTest : public testing::TestWithParam<CleanStream> {};

INSTANTIATE_TEST_SUITE_P(
    Types,
    RampsOfCleanStreamTest,
    testing::Values(
        CleanStream{"82_room", 32, false, true},
        CleanStream{"84_room", 96, true, false},
        CleanStream{"85_room", 40, false, false},
        CleanStream{"86_room", 64, false, false}
    ),
    [](const auto& test) { return "answers_" + test.param.vector; }
);

TEST_P(RampsOfCleanStreamTest, AreFoundFromAnySampleOnWithoutAnException) {
    const auto vector = test::load_vector(GetParam().vector);
    const auto samples = decode(vector);
    for (std::size_t first = 0; first < 100; ++first) {
        const auto slice = std::span<const Sample>(samples).subspan(first, 1000);
        const auto ramps = fit_ramps(slice, vector.type);
        ASSERT_TRUE(ramps.has_value()) << first;
        EXPECT_EQ(ramps->length, GetParam().length);
        EXPECT_EQ(ramps->parallax, GetParam().parallax);
        EXPECT_EQ(ramps->corrections.size(), GetParam().corrections ? slice.size() : 0);
        EXPECT_EQ(ramps->fixes.size(), 0U) << first;
    }
}

TEST(AngleRamps, ListTheSampleThatDoesNotFit) {
    const auto vector = test::load_vector("84_room");
    auto samples = decode(vector);
    samples.resize(1000);
    const auto far = std::max_element(samples.begin(), samples.end(), [](auto& a, auto& b) {
        return a.distance < b.distance;
    });
    far->distance.raw = 0;  // its angle still is that of its distance
    const auto ramps = fit_ramps(samples, vector.type);
    ASSERT_TRUE(ramps.has_value());
    ASSERT_EQ(ramps->fixes.size(), 1U);
    EXPECT_EQ(ramps->fixes[0].index, static_cast<std::size_t>(far - samples.begin()));
    EXPECT_EQ(from_columns(columns_of(samples, vector.type)).value().sweep.samples, samples);
}

TEST(AngleRamps, AreNotUsedWithCoarserDistancesFromWhichParallaxWouldComeOutWrong) {
    const auto vector = test::load_vector("84_room");
    auto samples = decode(vector);
    samples.resize(1000);
    FrameContent content;
    content.samples = samples;
    content.answer_type = vector.type;
    v1::Scan scan;
    to_columns(content, {.distance_unit_um = 100'000}, scan);
    const auto decoded = from_columns(scan).value().sweep.samples;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        ASSERT_EQ(decoded[i].angle, samples[i].angle) << i;
    }
}

TEST(AngleRamps, AreGivenUpWhereSamplesWereTakenOut) {
    const auto vector = test::load_vector("84_room");
    const auto samples = decode(vector);
    std::vector<Sample> thinned;
    for (std::size_t i = 0; i < 2000; i += i % 5 + 1) {
        thinned.push_back(samples[i]);
    }
    const auto scan = columns_of(thinned, vector.type);
    EXPECT_FALSE(scan.has_ramps());
    EXPECT_EQ(from_columns(scan).value().sweep.samples, thinned);
}

}  // namespace
}  // namespace sweepcast::frame
