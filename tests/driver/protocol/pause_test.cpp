// Capsules that never came while the scanner turned on: nobody can tell from the angles how often
// it went around.
#include "driver/protocol/encode_express.hpp"
#include "tests/driver/protocol/decoding.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <tuple>

namespace sweepcast::protocol {
namespace {

using std::chrono::microseconds;
using namespace std::chrono_literals;
using Capsule = std::array<std::uint8_t, packet_size(AnswerType::express)>;

constexpr auto sample_duration = 250us;
constexpr std::size_t samples_per_capsule = 32;
constexpr auto capsule_time = std::int64_t{samples_per_capsule} * sample_duration;
constexpr std::size_t clean = 40;
/// 24.3 degrees a capsule: fifteen of them turn it by one turn and about a fifth of a capsule.
constexpr unsigned steady_q6 = 1555;

/// A scanner whose distances are all different enough to know each sample again.
class PauseTest : public testing::Test {
protected:
    void SetUp() override {
        std::mt19937 random(82);
        std::uint32_t angle = 0;
        for (std::size_t i = 0; i < 240; ++i) {
            ExpressCapsule capsule{};
            capsule.start_angle = {static_cast<std::uint16_t>(angle % 23040)};
            angle += turned_q6(i);
            for (auto& sample : capsule.samples) {
                sample.distance_mm = static_cast<std::uint16_t>(1 + random() % 16383);
            }
            capsules_.push_back(encode_express(capsule));
        }
    }

    [[nodiscard]] virtual unsigned turned_q6(std::size_t) const { return steady_q6; }

    /// Capsule `index` comes, at its time or later and not before the one before it, in a block
    /// with others.
    void receive(std::size_t index, microseconds late = 0us, std::size_t together = 1) {
        Bytes block;
        for (std::size_t i = 0; i < together; ++i) {
            const auto& capsule = capsules_.at(index + i);
            block.insert(block.end(), capsule.begin(), capsule.end());
        }
        const auto last = static_cast<std::int64_t>(index + together);
        now_ = std::max(now_, SampleTime{1s + last * capsule_time + late});
        decoder_.push(block, {now_, per_byte_}, decoded_);
    }

    void receive_clean(std::size_t from, std::size_t count) {
        for (auto i = from; i < from + count; ++i) {
            receive(i);
        }
    }

    static double in_degrees(const Sample& sample) { return sample.angle.raw * 90.0 / 16384.0; }

    using Content = std::tuple<std::uint16_t, std::uint32_t>;
    static std::multiset<Content> contents(const Decoded& decoded) {
        std::multiset<Content> all;
        for (const auto& sample : decoded.samples) {
            all.emplace(sample.angle.raw, sample.distance.raw);
        }
        return all;
    }

    [[nodiscard]] Bytes stream() const {
        Bytes bytes;
        for (const auto& capsule : capsules_) {
            bytes.insert(bytes.end(), capsule.begin(), capsule.end());
        }
        return bytes;
    }

    /// That many samples came out, and none that is not of the stream.
    void expect_only_the_truth(std::size_t count) const {
        const auto seen = contents(decoded_);
        EXPECT_EQ(seen.size(), count);
        const auto true_ones = contents(decode_whole(AnswerType::express, stream()));
        EXPECT_TRUE(std::ranges::includes(true_ones, seen));
    }

    /// No sample is farther from where it was measured.
    void expect_nearly_the_truth(double degrees) const {
        const auto whole = decode_whole(AnswerType::express, stream());
        std::map<std::uint32_t, std::vector<double>> true_angles;
        for (const auto& sample : whole.samples) {
            true_angles[sample.distance.raw].push_back(in_degrees(sample));
        }
        for (const auto& sample : decoded_.samples) {
            const auto near = [&](double angle) {
                return std::abs(std::remainder(angle - in_degrees(sample), 360.0)) <= degrees;
            };
            EXPECT_TRUE(std::ranges::any_of(true_angles[sample.distance.raw], near));
        }
    }

    [[nodiscard]] std::size_t told_lost() const {
        std::size_t lost = 0;
        for (const auto& event : decoded_.events) {
            lost += event.kind == DecodeEventKind::packets_lost ? event.count : 0;
        }
        return lost;
    }

    SampleTime now_{};
    std::chrono::nanoseconds per_byte_{86'806};  // at 115200 baud
    std::vector<Capsule> capsules_;
    Decoder decoder_ = make_decoder(AnswerType::express, {.sample_duration = sample_duration});
    Decoded decoded_;
};

class LossTest : public PauseTest, public testing::WithParamInterface<std::size_t> {};

TEST_P(LossTest, OfCapsulesGivesNoSampleAWrongAngle) {
    receive_clean(0, clean);
    receive_clean(clean + GetParam(), clean);
    // The last is not decoded yet; the one before the loss is, if the turn is sure.
    constexpr std::size_t most = 2 * clean - 1;
    const auto capsules = decoded_.samples.size() / samples_per_capsule;
    EXPECT_GE(capsules, most - 1);
    expect_only_the_truth(capsules * samples_per_capsule);
    EXPECT_EQ(told_lost(), capsules < most ? 1 : GetParam());
}

TEST_P(LossTest, OfAnotherCapsuleAgainAndAgainGivesNoSampleAWrongAngle) {
    receive_clean(0, clean);
    for (auto i = clean + 1; i < clean + 1 + 2 * GetParam(); i += 2) {
        receive(i);
    }
    receive_clean(clean + 1 + 2 * GetParam(), clean);
    expect_only_the_truth((2 * clean + GetParam() - 1) * samples_per_capsule);
    EXPECT_EQ(told_lost(), GetParam() + 1);
}

TEST_P(LossTest, RightAfterALateCapsuleGivesNoSampleAWrongAngle) {
    receive_clean(0, clean - 1);
    receive(clean - 1, capsule_time);
    receive_clean(clean + GetParam(), clean);
    const auto capsules = decoded_.samples.size() / samples_per_capsule;
    EXPECT_GE(capsules, 2 * clean - 2);
    expect_only_the_truth(capsules * samples_per_capsule);
}

INSTANTIATE_TEST_SUITE_P(UpToFourTurns, LossTest, testing::Range<std::size_t>(1, 61));

class SpinUpTest : public LossTest {
protected:
    [[nodiscard]] unsigned turned_q6(std::size_t capsule) const override {
        return std::min(100 + static_cast<unsigned>(capsule) * 12, steady_q6);
    }
};

TEST_P(SpinUpTest, ALossTurnsNoSampleByMoreThanAnEighthOfACapsule) {
    receive_clean(0, 20);
    receive_clean(20 + GetParam(), clean);
    const auto capsules = decoded_.samples.size() / samples_per_capsule;
    EXPECT_GE(capsules, clean + 20 - 2);
    expect_nearly_the_truth(steady_q6 / 8.0 / 64.0);
}

INSTANTIATE_TEST_SUITE_P(UpToFourTurns, SpinUpTest, testing::Range<std::size_t>(1, 61));

/// How many capsules came before the loss, and how many were lost.
class EarlyLossTest : public PauseTest,
                      public testing::WithParamInterface<std::tuple<std::size_t, std::size_t>> {
protected:
    /// At least so many capsules came out, all of them true, and at least so many losses were told.
    void expect_the_truth_of(std::size_t least_capsules, std::size_t least_lost) const {
        const auto capsules = decoded_.samples.size() / samples_per_capsule;
        EXPECT_GE(capsules, least_capsules);
        expect_only_the_truth(capsules * samples_per_capsule);
        EXPECT_GE(told_lost(), least_lost);
    }
};

TEST_P(EarlyLossTest, BeforeTheSpeedIsKnownGivesNoSampleAWrongAngle) {
    const auto [before, lost] = GetParam();
    receive_clean(0, before);
    receive_clean(before + lost, clean);
    expect_the_truth_of(before + clean - 2, 1);
}

TEST_P(EarlyLossTest, WithAnotherRightAfterItGivesNoSampleAWrongAngle) {
    const auto [before, lost] = GetParam();
    receive_clean(0, before);
    receive(before + lost);
    receive_clean(before + 2 * lost + 1, clean);
    expect_the_truth_of(before + clean - 2, 2);
}

TEST_P(EarlyLossTest, WithALateCapsuleAndAnotherAfterItGivesNoSampleAWrongAngle) {
    const auto [before, lost] = GetParam();
    receive_clean(0, before);
    receive(before + lost, capsule_time);
    receive_clean(before + 2 * lost + 1, clean);
    expect_the_truth_of(before + clean - 2, 2);
}

TEST_P(EarlyLossTest, WithDamageSoonAfterItGivesNoSampleAWrongAngle) {
    const auto [before, lost] = GetParam();
    receive_clean(0, before);
    receive(before + lost);
    receive(before + 2 * lost + 1);
    capsules_[before + 2 * lost + 2].back() ^= 1;
    receive(before + 2 * lost + 2);
    capsules_[before + 2 * lost + 2].back() ^= 1;
    expect_the_truth_of(before - 1, 1);
}

INSTANTIATE_TEST_SUITE_P(
    OfAFewCapsules,
    EarlyLossTest,
    testing::Combine(testing::Range<std::size_t>(1, 6), testing::Range<std::size_t>(1, 5))
);

TEST_F(PauseTest, CapsulesThatComeLateButTogetherAreAllDecoded) {
    receive_clean(0, clean);
    receive(clean, 0us, 40);
    receive_clean(clean + 40, clean);
    expect_only_the_truth((2 * clean + 39) * samples_per_capsule);
    EXPECT_EQ(told_lost(), 0U);
}

TEST_F(PauseTest, OnANetworkCapsulesThatComeLateCostOneAtMost) {
    per_byte_ = 0ns;
    receive_clean(0, clean);
    receive(clean, 0us, 40);
    receive_clean(clean + 40, clean);
    expect_only_the_truth((2 * clean + 38) * samples_per_capsule);
    EXPECT_EQ(told_lost(), 1U);
}

TEST_F(PauseTest, AnAdapterThatDeliversInBurstsLosesNothing) {
    for (std::size_t i = 0; i < 160; i += 16) {
        receive(i, 0us, 16);
    }
    expect_only_the_truth(159 * samples_per_capsule);
    EXPECT_EQ(told_lost(), 0U);
}

TEST_F(PauseTest, AHostThatIsLateNowAndThenLosesNothing) {
    for (std::size_t i = 0; i < 160; ++i) {
        receive(i, i % 11 == 0 ? static_cast<std::int64_t>(i % 5) * capsule_time : 0us);
    }
    expect_only_the_truth(159 * samples_per_capsule);
}

TEST_F(PauseTest, AHostThatIsLateBeforeTheSpeedIsKnownLosesNothing) {
    receive(0);
    receive(1, 2 * capsule_time);
    receive_clean(2, clean);
    expect_only_the_truth((clean + 1) * samples_per_capsule);
    EXPECT_EQ(told_lost(), 0U);
}

TEST_F(PauseTest, AScannerSlowerThanItSaysIsDecoded) {
    decoder_ = make_decoder(AnswerType::express, {.sample_duration = sample_duration / 10});
    receive_clean(0, clean);
    // Besides the latest, two that came before its rate was known: packets might have been missing.
    EXPECT_GE(decoded_.samples.size(), (clean - 3) * samples_per_capsule);
}

class UnsteadyTest : public PauseTest {
protected:
    [[nodiscard]] unsigned turned_q6(std::size_t capsule) const override {
        return capsule % 2 == 0 ? steady_q6 : steady_q6 * 4 / 5;
    }
};

TEST_F(UnsteadyTest, AScannerSlowerThanItSaysIsDecodedOnceThatIsKnown) {
    decoder_ = make_decoder(AnswerType::express, {.sample_duration = sample_duration / 10});
    receive_clean(0, clean);
    EXPECT_GE(decoded_.samples.size(), (clean - 6) * samples_per_capsule);
}

}  // namespace
}  // namespace sweepcast::protocol
