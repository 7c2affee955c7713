// The sweep under way is always the beginning of the sweep that comes out.
#include "driver/protocol/sweep_assembler.hpp"
#include "tests/driver/protocol/decoding.hpp"
#include "tests/support/vector.hpp"

#include <gtest/gtest.h>

#include <string>

namespace sweepcast::protocol {
namespace {

/// Follows an assembler as one that sends out what is new of a sweep at once would.
class Follower {
public:
    void push(const Decoded& decoded) {
        std::vector<Sweep> finished;
        assembler_.push(decoded, finished);
        for (const auto& sweep : finished) {
            EXPECT_GT(sweep.begun, last_finished_);
            last_finished_ = sweep.begun;
            if (sweep.begun == begun_) {
                add(sweep.samples);
                EXPECT_EQ(told_, sweep.samples);
            }
            sweeps.push_back(sweep);
        }
        const auto under_way = assembler_.unfinished();
        if (under_way.samples.empty()) {
            return;
        }
        if (under_way.begun != begun_) {
            given_up += begun_ > last_finished_ ? 1 : 0;
            told_.clear();
            begun_ = under_way.begun;
        }
        add(under_way.samples);
        greatest_progress = std::max(greatest_progress, told_.size());
    }

    std::vector<Sweep> sweeps;
    int given_up{};
    std::size_t greatest_progress{};

private:
    /// Appends what is new; what was told before must stay as it was.
    void add(std::span<const Sample> samples) {
        ASSERT_GE(samples.size(), told_.size());
        EXPECT_TRUE(std::equal(told_.begin(), told_.end(), samples.begin()));
        const auto fresh = samples.subspan(told_.size());
        told_.insert(told_.end(), fresh.begin(), fresh.end());
    }

    SweepAssembler assembler_;
    std::vector<Sample> told_;
    std::uint64_t begun_{};
    std::uint64_t last_finished_{};
};

class SweepProgressTest : public testing::TestWithParam<std::string> {};

TEST_P(SweepProgressTest, AddsUpToTheSweepWhereverTheStreamIsCut) {
    const auto vector = test::load_vector(GetParam());
    Follower whole;
    whole.push(decode_whole(vector.type, vector.bytes, vector.settings));
    const auto packet = packet_size(vector.type);
    std::vector<std::size_t> pieces{packet, packet - 1, 1, 7, 3 * packet + 11};
    for (const auto piece : pieces) {
        auto decoder = make_decoder(vector.type, vector.settings);
        Follower follower;
        for (std::size_t at = 0; at < vector.bytes.size(); at += piece) {
            const auto rest = std::span(vector.bytes).subspan(at);
            Decoded decoded;
            decoder.push(rest.first(std::min(piece, rest.size())), {}, decoded);
            follower.push(decoded);
        }
        EXPECT_EQ(follower.sweeps, whole.sweeps) << "cut every " << piece << " bytes";
        EXPECT_GT(follower.greatest_progress, 0U);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Vectors,
    SweepProgressTest,
    testing::Values(
        "81_room",
        "81_damage",
        "82_room",
        "82_border",
        "82_damage",
        "83_room",
        "83_damage",
        "84_room",
        "84_border",
        "84_damage",
        "85_room",
        "85_damage",
        "86_room",
        "86_damage"
    ),
    [](const auto& vector) { return "v" + vector.param; }
);

Sample sample_at(std::size_t degree) {
    return {
        .distance = {4000},
        .angle = {static_cast<std::uint16_t>(degree % 360 * 65536 / 360)},
        .flag = static_cast<std::uint8_t>(degree % 360 == 0 ? 1 : 0)};
}

TEST(SweepProgressTest, ASweepGivenUpIsFollowedByAnotherNumber) {
    Follower follower;
    for (std::size_t degree = 0; degree < 100; ++degree) {
        follower.push({{sample_at(degree)}, {}});
    }
    follower.push({{}, {{0, DecodeEventKind::scan_reset}}});
    for (std::size_t degree = 0; degree < 800; ++degree) {
        follower.push({{sample_at(degree)}, {}});
    }
    EXPECT_EQ(follower.given_up, 1);
    ASSERT_EQ(follower.sweeps.size(), 2U);
    EXPECT_EQ(follower.sweeps[0].begun, 2U);
    EXPECT_EQ(follower.sweeps[0].losses.discarded_samples, 100U);
}

TEST(SweepProgressTest, ASweepGivenUpAndAnotherBegunAtOnceAreTold) {
    Follower follower;
    for (std::size_t degree = 0; degree < 100; ++degree) {
        follower.push({{sample_at(degree)}, {}});
    }
    Decoded decoded;
    decoded.events.push_back({0, DecodeEventKind::scan_reset});
    for (std::size_t degree = 0; degree < 200; ++degree) {
        decoded.samples.push_back(sample_at(degree));
    }
    follower.push(decoded);
    EXPECT_EQ(follower.given_up, 1);
}

TEST(SweepProgressTest, ASweepThatGrowsBeyondAnySizeIsGivenUp) {
    Follower follower;
    for (std::size_t i = 0; i <= max_sweep_samples; ++i) {
        follower.push({{i == 0 ? sample_at(0) : sample_at(90)}, {}});
    }
    for (std::size_t degree = 90; degree < 500; ++degree) {
        follower.push({{sample_at(degree)}, {}});
    }
    EXPECT_EQ(follower.given_up, 1);
    EXPECT_EQ(follower.greatest_progress, max_sweep_samples);
}

}  // namespace
}  // namespace sweepcast::protocol
