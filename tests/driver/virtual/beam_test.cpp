// Beam: noise, dropouts, limits and repeatability of measurements.
#include "driver/virtual/beam.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace sweepcast::virtual_lidar {
namespace {

constexpr BeamTraits traits{
    .min_distance_mm = 150,
    .max_distance_mm = 12'000,
    .noise_floor_mm = 2,
    .noise_part = 0.002};

Beam beam_on(double distance_mm, const BeamSettings& settings) {
    auto map =
        PolarMap::parse("angle_deg,distance_mm\n0," + std::to_string(distance_mm) + "\n", "test");
    return Beam(std::make_shared<const World>(std::move(*map)), traits, settings);
}

struct Statistics {
    double mean_mm{};
    double deviation_mm{};
    double without_echo{};  // part of all
};

Statistics measure_often(Beam beam) {
    constexpr int count = 20'000;
    std::vector<double> distances;
    for (int i = 0; i < count; ++i) {
        const auto echo = beam.measure(0.0, Seconds(0));
        if (echo.distance_mm > 0.0) {
            distances.push_back(echo.distance_mm);
        }
    }
    Statistics result;
    const auto echoes = static_cast<double>(distances.size());
    for (const double d : distances) {
        result.mean_mm += d / echoes;
    }
    for (const double d : distances) {
        result.deviation_mm += (d - result.mean_mm) * (d - result.mean_mm) / echoes;
    }
    result.deviation_mm = std::sqrt(result.deviation_mm);
    result.without_echo = 1.0 - echoes / count;
    return result;
}

TEST(Beam, WithoutNoiseMeasuresTheWorldAsItIs) {
    auto beam = beam_on(1234.5, {.noise_mm = 0.0});
    for (int i = 0; i < 100; ++i) {
        EXPECT_EQ(beam.measure(0.0, Seconds(i)).distance_mm, 1234.5);
    }
}

TEST(Beam, HasTheNoiseAskedForAtAnyDistance) {
    const auto near = measure_often(beam_on(1000.0, {.noise_mm = 10.0, .seed = 1}));
    const auto far = measure_often(beam_on(9000.0, {.noise_mm = 10.0, .seed = 2}));
    EXPECT_NEAR(near.mean_mm, 1000.0, 0.3);
    EXPECT_NEAR(near.deviation_mm, 10.0, 0.3);
    EXPECT_NEAR(far.deviation_mm, 10.0, 0.3);
}

TEST(Beam, HasTheNoiseOfThePersonaByDefault) {
    EXPECT_NEAR(measure_often(beam_on(500.0, {})).deviation_mm, 2.0, 0.06);
    EXPECT_NEAR(measure_often(beam_on(5000.0, {})).deviation_mm, 10.0, 0.3);
}

TEST(Beam, LosesThePartOfEchoesAskedFor) {
    EXPECT_EQ(measure_often(beam_on(1000.0, {.dropout = 0.0})).without_echo, 0.0);
    EXPECT_NEAR(measure_often(beam_on(1000.0, {.dropout = 0.1})).without_echo, 0.1, 0.01);
    EXPECT_EQ(measure_often(beam_on(1000.0, {.dropout = 1.0})).without_echo, 1.0);
}

TEST(Beam, SeesNothingOutsideItsRange) {
    for (const double distance_mm : {1.0, 149.0, 12'001.0, 50'000.0}) {
        const auto echo = beam_on(distance_mm, {}).measure(0.0, Seconds(0));
        EXPECT_EQ(echo.distance_mm, 0.0) << distance_mm;
        EXPECT_EQ(echo.quality6, 0) << distance_mm;
    }
}

TEST(Beam, NeverMeasuresBeyondItsRangeByNoise) {
    auto beam = beam_on(11'999.0, {.noise_mm = 1000.0});
    for (int i = 0; i < 1000; ++i) {
        const auto echo = beam.measure(0.0, Seconds(0));
        EXPECT_LE(echo.distance_mm, traits.max_distance_mm);
        EXPECT_GE(echo.distance_mm, traits.min_distance_mm);
    }
}

TEST(Beam, SeesBetterWhatIsNear) {
    const auto quality = [](double distance_mm) {
        return beam_on(distance_mm, {.noise_mm = 0.0}).measure(0.0, Seconds(0)).quality6;
    };
    EXPECT_GT(quality(500.0), quality(3000.0));
    EXPECT_GT(quality(3000.0), quality(11'000.0));
    EXPECT_GT(quality(12'000.0), 0);
    EXPECT_LE(quality(150.0), 63);
}

TEST(Beam, RepeatsItselfWithTheSameSeedOnly) {
    const auto run = [](std::uint64_t seed) {
        auto beam = beam_on(1000.0, {.noise_mm = 5.0, .dropout = 0.2, .seed = seed});
        std::vector<double> distances;
        for (int i = 0; i < 50; ++i) {
            distances.push_back(beam.measure(0.0, Seconds(0)).distance_mm);
        }
        return distances;
    };
    EXPECT_EQ(run(42), run(42));
    EXPECT_NE(run(42), run(43));
}

TEST(Random, GivesTheNumbersOfItsDefinition) {
    Random random(1234567);  // the published test values of SplitMix64
    EXPECT_EQ(random.next(), 6457827717110365317U);
    EXPECT_EQ(random.next(), 3203168211198807973U);
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
