// apply_wish: what each part of a wish makes of samples.
#include "server/frame/apply_wish.hpp"

#include "server/frame/angle_units.hpp"
#include "tests/server/frame/random_sweep.hpp"
#include "tests/server/frame/random_wish.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace sweepcast::frame {
namespace {

using namespace std::chrono_literals;
using protocol::Sample;
using Samples = std::vector<Sample>;

Sample sample(double degrees, double millimetres, std::uint8_t quality = 100) {
    Sample result;
    result.angle.raw = static_cast<std::uint16_t>(degrees * 65536 / 360 + 0.5);
    result.distance.raw = static_cast<std::uint32_t>(millimetres * 4);
    result.quality = quality;
    result.time = protocol::SampleTime(std::chrono::microseconds(static_cast<int>(degrees * 100)));
    return result;
}

Samples wished(const Wish& wish, const Samples& samples, std::size_t first = 0) {
    Samples memory;
    const auto result = apply_wish(wish, samples, first, memory);
    return {result.begin(), result.end()};
}

Wish windows(std::vector<AngleWindow> keep, std::vector<AngleWindow> mask) {
    Wish wish;
    wish.angles = AngleSet(keep, mask);
    return wish;
}

Wish bins(std::uint32_t count, BinPick pick = BinPick::nearest_angle) {
    Wish wish;
    wish.bins = {count, pick};
    return wish;
}

TEST(ApplyWish, AWishForNothingSpecialCostsNoCopy) {
    const Samples samples{sample(0, 1000)};
    Samples memory;
    EXPECT_EQ(apply_wish(Wish{}, samples, 0, memory).data(), samples.data());
}

TEST(ApplyWish, WindowsLeaveSamplesOut) {
    const Samples all{sample(0, 1), sample(90, 2), sample(180, 3), sample(270, 4)};
    EXPECT_EQ(wished(windows({{90, 270}}, {}), all), (Samples{all[1], all[2]}));
    EXPECT_EQ(wished(windows({{270, 1}}, {}), all), (Samples{all[0], all[3]}));
    EXPECT_EQ(wished(windows({}, {{80, 100}}), all), (Samples{all[0], all[2], all[3]}));
    EXPECT_EQ(wished(windows({{0, 200}}, {{80, 100}}), all), (Samples{all[0], all[2]}));
}

TEST(ApplyWish, LimitsOfRangeAndQualityTakeTheEchoAndLeaveTheSample) {
    Wish wish;
    wish.nearest.raw = 100 * 4;
    wish.farthest.raw = 200 * 4;
    wish.min_quality = 50;
    const Samples all{
        sample(0, 99),
        sample(1, 100),
        sample(2, 200),
        sample(3, 201),
        sample(4, 150, 49),
        sample(5, 0, 3)};
    const auto result = wished(wish, all);
    ASSERT_EQ(result.size(), all.size());
    EXPECT_EQ(result[1], all[1]);
    EXPECT_EQ(result[2], all[2]);
    EXPECT_EQ(result[5], all[5]);  // had none before
    for (const std::size_t i : {0U, 3U, 4U}) {
        EXPECT_FALSE(result[i].distance.has_echo());
        EXPECT_EQ(result[i].quality, 0);
        EXPECT_EQ(result[i].angle, all[i].angle);
        EXPECT_EQ(result[i].time, all[i].time);
    }
}

TEST(ApplyWish, EveryNthCountsFromTheSweepsFirstSample) {
    Wish wish;
    wish.every_nth = 3;
    Samples all;
    for (int i = 0; i < 10; ++i) {
        all.push_back(sample(i, 1000 + i));
    }
    EXPECT_EQ(wished(wish, all), (Samples{all[0], all[3], all[6], all[9]}));
    EXPECT_EQ(wished(wish, {all[4], all[5], all[6], all[7]}, 4), Samples{all[6]});
    EXPECT_EQ(wished(wish, {all[4], all[5]}, 4), Samples{});
}

TEST(ApplyWish, BinsAreAsManyAsWishedAtTheSameAnglesWhateverWasMeasured) {
    std::mt19937_64 random(4);  // NOLINT(cert-msc51-cpp): the same sweeps in every run
    for (const std::uint32_t count : {1U, 2U, 7U, 360U, 720U, 11520U, 16384U}) {
        auto measured = random_sweep(random).sweep.samples;
        measured.push_back(sample(1, 1));
        const auto result = wished(bins(count), measured);
        ASSERT_EQ(result.size(), count);
        for (std::uint32_t bin = 0; bin < count; ++bin) {
            ASSERT_EQ(to_units(result[bin].angle, 2 * count), 2 * bin + 1);
            ASSERT_EQ(result[bin].flag, bin == 0 ? 1 : 0);
        }
    }
}

TEST(ApplyWish, ABinHoldsTheSampleNearestToItsMiddle) {
    const auto result =
        wished(bins(4), {sample(10, 1), sample(44, 2), sample(47, 3), sample(91, 4)});
    EXPECT_EQ(result[0].distance.millimetres(), 2);
    EXPECT_EQ(result[0].angle.degrees(), 45);
    EXPECT_EQ(result[0].time, sample(44, 2).time);
    EXPECT_EQ(result[1].distance.millimetres(), 4);
    EXPECT_FALSE(result[2].distance.has_echo());
    EXPECT_FALSE(result[3].distance.has_echo());
}

TEST(ApplyWish, ABinOfMinimaHoldsTheNearestEcho) {
    const auto result = wished(
        bins(2, BinPick::minimum),
        {sample(10, 5), sample(90, 0), sample(100, 3), sample(110, 4), sample(200, 0)}
    );
    EXPECT_EQ(result[0].distance.millimetres(), 3);
    EXPECT_FALSE(result[1].distance.has_echo());
    EXPECT_EQ(result[1].time, sample(200, 0).time);
}

TEST(ApplyWish, EmptyBinsGetTheTimeThatTheirNeighboursSuggest) {
    const auto result = wished(bins(6), {sample(90, 1), sample(270, 2)});
    const auto first = sample(90, 1).time;
    EXPECT_EQ(result[0].time, first);
    EXPECT_EQ(result[1].time, first);
    EXPECT_EQ(result[2].time, first + 6000us);
    EXPECT_EQ(result[3].time, first + 12000us);
    EXPECT_EQ(result[5].time, sample(270, 2).time);
}

TEST(ApplyWish, MaskedBinsHaveNoEchoButTheirTime) {
    auto wish = windows({}, {{0, 100}});
    wish.bins = {4};
    const auto result =
        wished(wish, {sample(45, 1), sample(95, 2), sample(135, 3), sample(225, 4)});
    EXPECT_FALSE(result[0].distance.has_echo());
    EXPECT_EQ(result[0].time, sample(45, 1).time);
    EXPECT_EQ(result[0].quality, 0);
    EXPECT_EQ(result[1].distance.millimetres(), 3);
}

TEST(ApplyWish, SlicesOfASweepAddUpToWhatTheWholeSweepBecomes) {
    std::mt19937_64 random(9);  // NOLINT(cert-msc51-cpp): the same sweeps in every run
    for (int i = 0; i < 500; ++i) {
        const auto wish = random_wish(Kind::sector, random);
        const auto samples = random_sweep(random).sweep.samples;
        Samples joined;
        Samples memory;
        for (std::size_t at = 0; at < samples.size();) {
            const auto size = std::min<std::size_t>(random() % 100, samples.size() - at);
            const auto part = apply_wish(wish, std::span(samples).subspan(at, size), at, memory);
            joined.insert(joined.end(), part.begin(), part.end());
            at += size;
        }
        ASSERT_EQ(joined, wished(wish, samples)) << i;
    }
}

}  // namespace
}  // namespace sweepcast::frame
