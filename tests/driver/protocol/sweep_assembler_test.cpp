// Streams of samples are cut into revolutions where a person would cut them.
#include "driver/protocol/sweep_assembler.hpp"

#include "driver/protocol/encode_dense.hpp"
#include "driver/protocol/encode_ultra_dense.hpp"
#include "tests/driver/protocol/decoding.hpp"
#include "tests/support/vector.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sweepcast::protocol {
namespace {

using std::chrono::microseconds;

constexpr microseconds sample_duration{500};

/// A scanner that takes samples at angles counted on without wrapping, in 1/65536 turn.
class Scanner {
public:
    /// Takes a sample; its time is its number, so that each is told from the others.
    void sample(double at, bool marked = false) {
        const auto wrapped = static_cast<std::int64_t>(std::floor(at)) & 0xFFFF;
        decoded.samples.push_back(
            {.time =
                 SampleTime{sample_duration * static_cast<std::int64_t>(decoded.samples.size())},
             .distance = {4000},
             .angle = {static_cast<std::uint16_t>(wrapped)},
             .quality = 188,
             .flag = static_cast<std::uint8_t>(marked ? 1 : 0)}
        );
    }

    /// Turns steadily, `step` from sample to sample, up to `end`; marks the first sample of each
    /// turn unless `marks` is false.
    void turn_to(double end, double step, bool marks = true) {
        while (position + step < end) {
            position += step;
            const bool new_turn =
                std::floor(position / turn) > std::floor((position - step) / turn);
            sample(position, marks && new_turn);
        }
    }

    void event(DecodeEventKind kind, std::size_t count = 1) {
        decoded.events.push_back({decoded.samples.size(), kind, count});
    }

    [[nodiscard]] std::vector<Sweep> sweeps() const {
        SweepAssembler assembler;
        std::vector<Sweep> finished;
        assembler.push(decoded, finished);
        return finished;
    }

    static constexpr double turn = 65536;
    double position{turn / 4};
    Decoded decoded;
};

std::vector<std::size_t> sizes(const std::vector<Sweep>& sweeps) {
    std::vector<std::size_t> result;
    for (const auto& sweep : sweeps) {
        result.push_back(sweep.samples.size());
    }
    return result;
}

using Sizes = std::vector<std::size_t>;
constexpr double turn = Scanner::turn;
constexpr double step = turn / 128;  // 128 samples a turn

TEST(SweepAssemblerTest, ASteadyStreamGivesOneSweepATurn) {
    Scanner scanner;
    scanner.turn_to(5.5 * turn, step);
    const auto sweeps = scanner.sweeps();
    EXPECT_EQ(sizes(sweeps), (Sizes{128, 128, 128, 128}));
    for (const auto& sweep : sweeps) {
        EXPECT_EQ(sweep.samples.front().angle.raw, 0);
        EXPECT_EQ(sweep.period, 128 * sample_duration);
        EXPECT_DOUBLE_EQ(sweep.rotation_hz(), 15.625);
    }
}

TEST(SweepAssemblerTest, SamplesStayInTheOrderTheyWereTakenAndNoneIsLost) {
    Scanner scanner;
    scanner.turn_to(4.5 * turn, step);
    std::vector<Sample> gathered;
    for (const auto& sweep : scanner.sweeps()) {
        gathered.insert(gathered.end(), sweep.samples.begin(), sweep.samples.end());
    }
    const auto first = scanner.decoded.samples.begin() + 95;  // the first at heading 0
    EXPECT_EQ(gathered, std::vector<Sample>(first, first + 3 * 128));
}

TEST(SweepAssemblerTest, TheCutOfTheStreamDoesNotMatter) {
    Scanner scanner;
    scanner.turn_to(6 * turn, step * 1.37);
    SweepAssembler assembler;
    std::vector<Sweep> finished;
    for (const auto& sample : scanner.decoded.samples) {
        assembler.push({{sample}, {}}, finished);
    }
    EXPECT_EQ(finished, scanner.sweeps());
}

TEST(SweepAssemblerTest, ALostMarkDoesNotJoinTwoTurns) {
    Scanner scanner;
    scanner.turn_to(2.5 * turn, step);
    scanner.turn_to(3.5 * turn, step, false);
    scanner.turn_to(5.5 * turn, step);
    EXPECT_EQ(sizes(scanner.sweeps()), (Sizes{128, 128, 128, 128}));
}

TEST(SweepAssemblerTest, TurnsAreFoundWithoutAnyMarks) {
    Scanner scanner;
    scanner.turn_to(5.5 * turn, step, false);
    EXPECT_EQ(sizes(scanner.sweeps()), (Sizes{128, 128, 128, 128}));
}

TEST(SweepAssemblerTest, AVaryingSpeedIsFollowed) {
    Scanner scanner;
    double speed = step;
    for (int i = 0; i < 2000; ++i) {
        speed = step * (1.0 + 0.5 * std::sin(i * 0.01));
        scanner.turn_to(scanner.position + 1.5 * speed, speed);
    }
    const auto sweeps = scanner.sweeps();
    EXPECT_EQ(sweeps.size(), static_cast<std::size_t>(scanner.position / turn) - 1);
    for (const auto& sweep : sweeps) {
        EXPECT_LT(sweep.samples.front().angle.raw, 2 * step);
        EXPECT_GT(sweep.samples.back().angle.raw, turn - 2 * step);
    }
}

TEST(SweepAssemblerTest, AMarkRightAfterThePassingOfZeroCountsOnce) {
    Scanner scanner;
    for (int i = 32; i < 5 * 128 + 64; ++i) {
        scanner.sample(i * step, i % 128 == 1);
    }
    EXPECT_EQ(sizes(scanner.sweeps()), (Sizes{128, 128, 128, 128}));
}

TEST(SweepAssemblerTest, AMarkShortlyBeforeZeroBeginsTheSweep) {
    Scanner scanner;
    for (int i = 32; i < 5 * 128 + 64; ++i) {
        scanner.sample(i * step, i % 128 == 126);
    }
    const auto sweeps = scanner.sweeps();
    EXPECT_EQ(sizes(sweeps), (Sizes{128, 128, 128, 128}));
    EXPECT_EQ(sweeps.front().samples.front().angle.raw, 126 * step);
}

TEST(SweepAssemblerTest, ADoubledMarkCountsOnce) {
    Scanner scanner;
    for (int i = 32; i < 5 * 128 + 64; ++i) {
        scanner.sample(i * step, i % 128 < 3);
    }
    EXPECT_EQ(sizes(scanner.sweeps()), (Sizes{128, 128, 128, 128}));
}

TEST(SweepAssemblerTest, AnglesThatGoBackAndForthOverZeroCountOnce) {
    Scanner scanner;
    for (int i = 32; i < 5 * 128 + 64; ++i) {
        scanner.sample(i * step + (i % 2 == 0 ? 3 : -3) * step);
    }
    EXPECT_EQ(scanner.sweeps().size(), 4U);
}

TEST(SweepAssemblerTest, SamplesBeforeTheFirstBeginningAreDroppedUncounted) {
    Scanner scanner;
    scanner.turn_to(2.5 * turn, step);
    const auto sweeps = scanner.sweeps();
    ASSERT_EQ(sweeps.size(), 1U);
    EXPECT_EQ(sweeps.front().losses, LineLosses{});
}

TEST(SweepAssemblerTest, AStreamThatBeginsWithAMarkBeginsAtOnce) {
    Scanner scanner;
    for (int i = 0; i <= 128; ++i) {
        scanner.sample(i * step, i % 128 == 0);
    }
    EXPECT_EQ(sizes(scanner.sweeps()), (Sizes{128}));
}

class BogusAngleTest : public testing::TestWithParam<int> {};

TEST_P(BogusAngleTest, OneAnywhereNeitherSplitsNorJoinsSweeps) {
    for (int bogus = 33; bogus < 5 * 128; ++bogus) {
        Scanner scanner;
        for (int i = 32; i < 5 * 128 + 64; ++i) {
            scanner.sample(i == bogus ? GetParam() : i * step, i % 128 == 0);
        }
        ASSERT_EQ(scanner.sweeps().size(), 4U) << "sample " << bogus;
    }
}

TEST_P(BogusAngleTest, AMarkOnOneThatIsFarOffCountsForNothing) {
    for (int bogus = 33; bogus < 5 * 128; ++bogus) {
        const auto off = static_cast<std::uint16_t>(GetParam() - (bogus - 1) * 512 + 65536 / 8);
        if (off <= 65536 / 4) {
            continue;  // within 1/8 turn of the sample before
        }
        Scanner scanner;
        for (int i = 32; i < 5 * 128 + 64; ++i) {
            scanner.sample(i == bogus ? GetParam() : i * step, i % 128 == 0 || i == bogus);
        }
        ASSERT_EQ(scanner.sweeps().size(), 4U) << "sample " << bogus;
    }
}

INSTANTIATE_TEST_SUITE_P(Angles, BogusAngleTest, testing::Range(0, 65536, 4099));

TEST(SweepAssemblerTest, AFewBogusAnglesInARowNeitherSplitNorJoinSweeps) {
    Scanner scanner;
    for (int i = 32; i < 5 * 128 + 64; ++i) {
        const bool bogus = i % 50 < 3;
        scanner.sample(bogus ? (i % 50) * 25000 + i * 7919 : i * step, i % 128 == 0);
    }
    EXPECT_EQ(scanner.sweeps().size(), 4U);
}

TEST(SweepAssemblerTest, ABogusFirstAngleBeginsNothing) {
    Scanner scanner;
    scanner.sample(0.9 * turn);
    scanner.turn_to(2.5 * turn, step);
    EXPECT_EQ(sizes(scanner.sweeps()), (Sizes{128}));
}

TEST(SweepAssemblerTest, ALossOfMoreThanHalfATurnOverZeroEndsTheSweep) {
    Scanner scanner;
    scanner.turn_to(2.7 * turn, step);
    scanner.position = 3.4 * turn;
    scanner.turn_to(5.5 * turn, step);
    const auto sweeps = scanner.sweeps();
    ASSERT_EQ(sweeps.size(), 4U);
    EXPECT_EQ(sweeps[0].samples.size(), 128U);
    EXPECT_LT(sweeps[1].samples.size(), 128U);
    EXPECT_LT(sweeps[2].samples.size(), 128U);
    EXPECT_EQ(sweeps[3].samples.size(), 128U);
}

TEST(SweepAssemblerTest, ARestartVoidsTheUnfinishedSweepAndCountsItsSamples) {
    Scanner scanner;
    scanner.turn_to(2.5 * turn, step);
    scanner.event(DecodeEventKind::scan_reset);
    scanner.position = 0.6 * turn;
    scanner.turn_to(3.5 * turn, step);
    const auto sweeps = scanner.sweeps();
    ASSERT_EQ(sizes(sweeps), (Sizes{128, 128, 128}));
    EXPECT_EQ(sweeps[0].losses.discarded_samples, 0U);
    EXPECT_EQ(sweeps[1].losses.discarded_samples, 64U);
    EXPECT_EQ(sweeps[2].losses.discarded_samples, 0U);
}

TEST(SweepAssemblerTest, ARestartBeforeAnySweepCountsNothing) {
    Scanner scanner;
    scanner.event(DecodeEventKind::scan_reset);
    scanner.turn_to(0.9 * turn, step);
    scanner.event(DecodeEventKind::scan_reset);
    scanner.position = 0.2 * turn;
    scanner.turn_to(2.5 * turn, step);
    EXPECT_EQ(scanner.sweeps().front().losses, LineLosses{});
}

TEST(SweepAssemblerTest, LossesGoWithTheSweepDuringWhichTheyHappened) {
    Scanner scanner;
    scanner.turn_to(2.5 * turn, step);
    scanner.event(DecodeEventKind::checksum_error);
    scanner.event(DecodeEventKind::bytes_skipped, 17);
    scanner.turn_to(2.7 * turn, step);
    scanner.event(DecodeEventKind::checksum_error);
    scanner.event(DecodeEventKind::packets_lost, 5);
    scanner.turn_to(4.5 * turn, step);
    const auto sweeps = scanner.sweeps();
    ASSERT_EQ(sweeps.size(), 3U);
    EXPECT_EQ(sweeps[0].losses, LineLosses{});
    EXPECT_EQ(sweeps[1].losses, (LineLosses{2, 17, 0, 5}));
    EXPECT_EQ(sweeps[2].losses, LineLosses{});
}

TEST(SweepAssemblerTest, AScannerThatStandsStillGivesNoSweepAndNoEndlessOne) {
    Scanner scanner;
    scanner.turn_to(2.5 * turn, step);
    const auto before = scanner.decoded.samples.size();
    for (std::size_t i = 0; i < 3 * max_sweep_samples; ++i) {
        scanner.sample(scanner.position);
    }
    const auto at_rest = scanner.decoded.samples.size() - before;
    scanner.turn_to(4.5 * turn, step);
    const auto sweeps = scanner.sweeps();
    ASSERT_EQ(sizes(sweeps), (Sizes{128, 128}));
    EXPECT_EQ(sweeps[1].losses.discarded_samples, 128 + at_rest);
}

TEST(SweepAssemblerTest, ASweepOfTheGreatestSizeIsGivenOut) {
    Scanner scanner;
    scanner.position = 0;
    scanner.sample(0, true);
    scanner.turn_to(2.5 * turn, turn / max_sweep_samples);
    const auto sweeps = scanner.sweeps();
    EXPECT_EQ(sizes(sweeps), (Sizes{max_sweep_samples, max_sweep_samples}));
}

TEST(SweepAssemblerTest, TheMemoryOfASpentSweepIsUsedAgain) {
    Scanner scanner;
    scanner.turn_to(2.5 * turn, step);
    SweepAssembler assembler;
    std::vector<Sweep> finished;
    assembler.push(scanner.decoded, finished);
    ASSERT_EQ(finished.size(), 1U);
    const auto* memory = finished.front().samples.data();
    assembler.recycle(std::move(finished.front()));
    finished.clear();
    for (int turns = 0; turns < 3 && (finished.empty() || finished.back().samples.data() != memory);
         ++turns) {
        scanner.decoded.clear();
        scanner.turn_to(scanner.position + turn, step);
        assembler.push(scanner.decoded, finished);
    }
    EXPECT_EQ(finished.back().samples.data(), memory);
}

std::ptrdiff_t marks(const std::vector<Sample>& samples) {
    return std::count_if(samples.begin(), samples.end(), [](const Sample& sample) {
        return sample.starts_revolution();
    });
}

std::vector<Sweep> sweeps_of(const Decoded& decoded) {
    SweepAssembler assembler;
    std::vector<Sweep> finished;
    assembler.push(decoded, finished);
    return finished;
}

TEST(SweepAssemblerTest, RealExpressCapsulesThatMeetAtZeroGiveOneSweepATurn) {
    const auto vector = test::load_vector("82_border");
    const auto sweeps = sweeps_of(decode_whole(vector.type, vector.bytes, vector.settings));
    // Four capsules a turn, the stream of 48 begins shortly before a heading 0 and ends shortly
    // after one.
    EXPECT_EQ(sweeps.size(), 11U);
    for (const auto& sweep : sweeps) {
        EXPECT_NEAR(static_cast<double>(sweep.samples.size()), 128, 32);
        EXPECT_TRUE(sweep.samples.front().starts_revolution());
    }
}

TEST(SweepAssemblerTest, RealUltraCapsulesThatMeetAtZeroGiveOneSweepATurnThoughMarksAreLost) {
    const auto vector = test::load_vector("84_border");
    const auto decoded = decode_whole(vector.type, vector.bytes, vector.settings);
    EXPECT_EQ(marks(decoded.samples), 7);  // of twelve: turns that end between two capsules
    const auto sweeps = sweeps_of(decoded);
    EXPECT_EQ(sweeps.size(), 11U);
    for (const auto& sweep : sweeps) {
        // One capsule of four covers nearly all of a turn, in others it takes 96 samples to go 7
        // degrees.
        EXPECT_NEAR(static_cast<double>(sweep.samples.size()), 4 * 96, 192);
    }
}

/// Whether a dense stream of so many capsules a turn, the first of which starts just there, comes
/// out as one sweep a turn. The recorded streams that meet at 0 cannot tell: most of each turn in
/// them is beyond what is believed.
template <std::size_t Size, class Capsule>
void expect_a_sweep_a_turn(
    AnswerType type,
    std::array<std::uint8_t, Size> (*encode)(const Capsule&),
    std::size_t samples_per_capsule
) {
    for (const unsigned capsules_per_turn : {11U, 12U, 15U, 16U}) {
        for (const unsigned first_start_q6 : {0U, 1U, 23039U}) {
            Bytes bytes;
            for (unsigned i = 0; i <= 12 * capsules_per_turn; ++i) {
                const auto start = (first_start_q6 + i * 23040 / capsules_per_turn) % 23040;
                Capsule capsule{};
                capsule.start_angle = {static_cast<std::uint16_t>(start)};
                const auto packet = encode(capsule);
                bytes.insert(bytes.end(), packet.begin(), packet.end());
            }
            const auto decoded = decode_whole(type, bytes, {.sample_duration = microseconds{31}});
            const auto sweeps = sweeps_of(decoded);
            EXPECT_GE(sweeps.size(), 11U);
            for (const auto& sweep : sweeps) {
                EXPECT_NEAR(
                    static_cast<double>(sweep.samples.size()),
                    static_cast<double>(capsules_per_turn * samples_per_capsule),
                    1
                );
                EXPECT_EQ(marks(sweep.samples), 1);
            }
        }
    }
}

TEST(SweepAssemblerTest, DenseCapsulesThatMeetAtZeroGiveOneSweepAndOneMarkATurn) {
    expect_a_sweep_a_turn(AnswerType::dense, encode_dense, 40);
}

TEST(SweepAssemblerTest, UltraDenseCapsulesThatMeetAtZeroGiveOneSweepAndOneMarkATurn) {
    expect_a_sweep_a_turn(AnswerType::ultra_dense, encode_ultra_dense, 64);
}

}  // namespace
}  // namespace sweepcast::protocol
