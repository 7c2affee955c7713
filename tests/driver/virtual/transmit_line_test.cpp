// TransmitLine: bytes leave at the baud rate, in order, and no more are kept than there is room
// for.
#include "driver/virtual/transmit_line.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t baud = 10'000;  // 1 ms a byte
constexpr Moment start{};

std::size_t taken_by(TransmitLine& line, Moment now) {
    std::vector<Transmitted> out;
    line.take(now, out);
    return std::accumulate(out.begin(), out.end(), std::size_t{0}, [](auto sum, const auto& part) {
        return sum + part.bytes.size();
    });
}

TEST(TransmitLine, SendsAByteInTenBitTimes) {
    TransmitLine line(baud);
    ASSERT_TRUE(line.push(Payload::answer, Bytes{1, 2, 3}, start));
    EXPECT_EQ(line.next_byte(), start + 1ms);
    EXPECT_EQ(taken_by(line, start + 999us), 0U);
    EXPECT_EQ(taken_by(line, start + 1ms), 1U);
    EXPECT_EQ(taken_by(line, start + 10ms), 2U);
    EXPECT_EQ(line.next_byte(), std::nullopt);
}

TEST(TransmitLine, IsNeverFasterThanItsBaudRate) {
    TransmitLine line(115'200);
    ASSERT_TRUE(line.push(Payload::answer, Bytes(4000), start));
    const auto first = taken_by(line, start + 100ms);
    const auto second = taken_by(line, start + 200ms);
    EXPECT_LE(first, 1152U);
    EXPECT_LE(first + second, 2304U);
    EXPECT_GE(first + second, 2303U) << "nor slower, but for the rounding";
    EXPECT_EQ(first + second + taken_by(line, start + 400ms), 4000U);
}

TEST(TransmitLine, SavesUpNoTimeWhileItHasNothingToSend) {
    TransmitLine line(baud);
    ASSERT_TRUE(line.push(Payload::answer, Bytes{1}, start));
    EXPECT_EQ(taken_by(line, start + 100ms), 1U);
    ASSERT_TRUE(line.push(Payload::answer, Bytes(10), start + 100ms));
    EXPECT_EQ(taken_by(line, start + 105ms), 5U);
}

TEST(TransmitLine, HoldsBytesBackUntilTheyAreReady) {
    TransmitLine line(baud);
    ASSERT_TRUE(line.push(Payload::answer, Bytes{1}, start + 5ms));
    EXPECT_EQ(taken_by(line, start + 5ms), 0U);
    EXPECT_EQ(taken_by(line, start + 6ms), 1U);
}

TEST(TransmitLine, KeepsOrderAndKinds) {
    TransmitLine line(baud);
    ASSERT_TRUE(line.push(Payload::answer, Bytes{1, 2}, start));
    ASSERT_TRUE(line.push(Payload::measurement, Bytes{3}, start));
    ASSERT_TRUE(line.push(Payload::measurement, Bytes{4}, start));
    ASSERT_TRUE(line.push(Payload::answer, Bytes{5}, start));
    std::vector<Transmitted> out;
    line.take(start + 1s, out);
    ASSERT_EQ(out.size(), 3U);
    EXPECT_EQ(out[0].payload, Payload::answer);
    EXPECT_EQ(out[0].bytes, (Bytes{1, 2}));
    EXPECT_EQ(out[1].payload, Payload::measurement);
    EXPECT_EQ(out[1].bytes, (Bytes{3, 4}));
    EXPECT_EQ(out[2].bytes, (Bytes{5}));
}

TEST(TransmitLine, RefusesWhatItHasNoRoomForAsAWhole) {
    TransmitLine line(baud);
    EXPECT_FALSE(line.push(Payload::answer, Bytes(TransmitLine::capacity + 1), start));
    EXPECT_TRUE(line.push(Payload::answer, Bytes(TransmitLine::capacity), start));
    EXPECT_FALSE(line.push(Payload::answer, Bytes{1}, start));
    EXPECT_TRUE(line.push(Payload::answer, Bytes{1}, start + 1ms)) << "one has left";
    EXPECT_EQ(taken_by(line, start + 1h), TransmitLine::capacity + 1);
}

TEST(TransmitLine, DropsMeasurementsButNotWhatIsAboutToLeave) {
    TransmitLine line(baud);
    ASSERT_TRUE(line.push(Payload::measurement, Bytes(100), start));
    ASSERT_TRUE(line.push(Payload::measurement, Bytes(100), start));
    line.drop_measurements(start + 10ms, 16);
    EXPECT_EQ(taken_by(line, start + 1s), 26U);
}

TEST(TransmitLine, DropsNoAnswers) {
    TransmitLine line(baud);
    ASSERT_TRUE(line.push(Payload::answer, Bytes(20), start));
    ASSERT_TRUE(line.push(Payload::measurement, Bytes(100), start));
    line.drop_measurements(start, 4);
    EXPECT_EQ(taken_by(line, start + 1s), 20U);
}

TEST(TransmitLine, IsAnsweringUntilTheAnswerHasLeft) {
    TransmitLine line(baud);
    EXPECT_FALSE(line.is_answering(start));
    ASSERT_TRUE(line.push(Payload::measurement, Bytes(2), start));
    EXPECT_FALSE(line.is_answering(start));
    ASSERT_TRUE(line.push(Payload::answer, Bytes(2), start));
    EXPECT_TRUE(line.is_answering(start + 3ms));
    EXPECT_FALSE(line.is_answering(start + 4ms));
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
