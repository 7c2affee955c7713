// ScanReader: bytes to sweeps, and the account of the line.
#include "driver/device/scan_reader.hpp"

#include "driver/protocol/encode_normal.hpp"

#include <gtest/gtest.h>

namespace sweepcast::device {
namespace {

using namespace std::chrono_literals;
using protocol::AnswerType;

std::vector<std::uint8_t> turn(std::uint16_t distance_q2) {
    std::vector<std::uint8_t> bytes;
    for (unsigned degree = 0; degree < 360; ++degree) {
        const auto packet = protocol::encode_normal({
            .starts_revolution = degree == 0,
            .quality6 = 40,
            .angle = {static_cast<std::uint16_t>(degree * 64)},
            .distance_q2 = distance_q2,
        });
        bytes.insert(bytes.end(), packet.begin(), packet.end());
    }
    return bytes;
}

class ScanReaderTest : public testing::Test {
protected:
    ScanReader make(double max_distance_mm) {
        const ScanMode mode{
            .name = "Standard",
            .answer_type = AnswerType::normal,
            .sample_duration = 500us,
            .max_distance_mm = max_distance_mm};
        return ScanReader::create(AnswerType::normal, mode, 115200, line).value();
    }

    LineQuality line;
    std::vector<protocol::Sweep> sweeps;
};

TEST_F(ScanReaderTest, GivesSweepsAndCountsWhatCame) {
    auto reader = make(0);
    const auto bytes = turn(4000);
    EXPECT_EQ(reader.push(bytes, {}, sweeps), 360U);
    EXPECT_EQ(reader.push(bytes, {}, sweeps), 360U);
    ASSERT_EQ(sweeps.size(), 1U);
    EXPECT_EQ(sweeps[0].samples.size(), 360U);
    EXPECT_EQ(line.bytes, 2 * bytes.size());
    EXPECT_EQ(line.samples, 720U);
    EXPECT_EQ(line.skipped_bytes, 0U);
}

TEST_F(ScanReaderTest, CountsNoise) {
    auto reader = make(0);
    const std::vector<std::uint8_t> noise(100, 0);
    EXPECT_EQ(reader.push(noise, {}, sweeps), 0U);
    EXPECT_GT(reader.push(turn(4000), {}, sweeps), 0U);
    EXPECT_EQ(line.skipped_bytes, noise.size());
}

TEST_F(ScanReaderTest, ADistanceBeyondTheRangeIsNoEcho) {
    auto reader = make(1000.0);
    reader.push(turn(4000), {}, sweeps);
    reader.push(turn(4001), {}, sweeps);
    reader.push(turn(4000), {}, sweeps);
    ASSERT_EQ(sweeps.size(), 2U);
    EXPECT_EQ(sweeps[0].samples[100].distance.raw, 4000U);
    EXPECT_EQ(sweeps[0].samples[100].quality, 160);
    EXPECT_EQ(sweeps[1].samples[100].distance.raw, 0U);
    EXPECT_EQ(sweeps[1].samples[100].quality, 0);
}

TEST_F(ScanReaderTest, RefusesAStreamThatCannotBeDecoded) {
    EXPECT_FALSE(ScanReader::create(static_cast<AnswerType>(0x99), {}, 0, line));
}

}  // namespace
}  // namespace sweepcast::device
