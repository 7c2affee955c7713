// When samples were taken, if the bytes of a block are known to have come one after another.
#include "driver/protocol/encode_dense.hpp"
#include "driver/protocol/encode_express.hpp"
#include "driver/protocol/encode_normal.hpp"
#include "driver/protocol/sample_timing.hpp"
#include "tests/driver/protocol/decoding.hpp"

#include <gtest/gtest.h>

namespace sweepcast::protocol {
namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

constexpr DecodeSettings settings{
    .sample_duration = microseconds{500},
    .baud = 0,
    .ethernet = true};
constexpr microseconds delay{500 + 250 + 100};  // a sample, half a sample, the network

SampleTime at(std::int64_t us) {
    return SampleTime{microseconds{us}};
}

std::vector<SampleTime> times_of(const Decoded& decoded) {
    std::vector<SampleTime> times;
    for (const auto& sample : decoded.samples) {
        times.push_back(sample.time);
    }
    return times;
}

Bytes normal_packets(unsigned count) {
    Bytes bytes;
    for (unsigned i = 0; i < count; ++i) {
        const auto packet = encode_normal({.angle = {static_cast<std::uint16_t>(100 * i)}});
        bytes.insert(bytes.end(), packet.begin(), packet.end());
    }
    return bytes;
}

TEST(SampleTimeTest, EachNormalPacketArrivedWithItsOwnLastByte) {
    auto decoder = make_decoder(AnswerType::normal, settings);
    Decoded decoded;
    decoder.push(normal_packets(3), {at(10'000), microseconds{10}}, decoded);
    EXPECT_EQ(
        times_of(decoded),
        (std::vector{at(9'900) - delay, at(9'950) - delay, at(10'000) - delay})
    );
}

TEST(SampleTimeTest, APacketCutInTwoArrivedWithItsSecondPart) {
    auto decoder = make_decoder(AnswerType::normal, settings);
    Decoded decoded;
    const auto bytes = normal_packets(3);
    decoder.push(std::span(bytes).first(8), {at(10'000), microseconds{10}}, decoded);
    decoder.push(std::span(bytes).subspan(8), {at(20'000), microseconds{10}}, decoded);
    EXPECT_EQ(
        times_of(decoded),
        (std::vector{at(9'970) - delay, at(19'950) - delay, at(20'000) - delay})
    );
}

TEST(SampleTimeTest, TheTimeOfAByteMayBeAFractionOfAMicrosecond) {
    auto decoder = make_decoder(AnswerType::normal, settings);
    Decoded decoded;
    decoder.push(normal_packets(2), {at(10'000), nanoseconds{900}}, decoded);
    EXPECT_EQ(times_of(decoded), (std::vector{at(9'995) - delay, at(10'000) - delay}));
}

TEST(SampleTimeTest, ACapsuleArrivedWithItsOwnLastByteNotTheNextCapsules) {
    Bytes bytes;
    for (const auto angle : {0, 1280}) {
        const auto capsule = encode_express(
            {.restart = false, .start_angle = {static_cast<std::uint16_t>(angle)}, .samples = {}}
        );
        bytes.insert(bytes.end(), capsule.begin(), capsule.end());
    }
    auto decoder = make_decoder(AnswerType::express, settings);
    Decoded decoded;
    decoder.push(std::span(bytes).first(100), {at(10'000), microseconds{10}}, decoded);
    decoder.push(std::span(bytes).subspan(100), {at(26'000), microseconds{10}}, decoded);
    ASSERT_EQ(decoded.samples.size(), 32U);
    EXPECT_EQ(decoded.samples.back().time, at(9'840) - delay);
    EXPECT_EQ(decoded.samples.front().time, at(9'840) - delay - 31 * microseconds{500});
}

TEST(SampleTimeTest, ASamplePeriodThatIsNoWholeMicrosecondIsTakenExactly) {
    Bytes bytes;
    for (const auto angle : {0, 640}) {
        const auto capsule = encode_dense(
            {.restart = false,
             .start_angle = {static_cast<std::uint16_t>(angle)},
             .distances_mm = {}}
        );
        bytes.insert(bytes.end(), capsule.begin(), capsule.end());
    }
    constexpr nanoseconds period{31'250};
    auto decoder = make_decoder(AnswerType::dense, {.sample_duration = period, .ethernet = true});
    Decoded decoded;
    decoder.push(bytes, {at(10'000), {}}, decoded);
    ASSERT_EQ(decoded.samples.size(), 40U);
    const auto last = at(10'000) - microseconds{31 + 15 + 100};
    for (int i = 0; i < 40; ++i) {
        const auto& sample = decoded.samples.at(static_cast<std::size_t>(i));
        EXPECT_EQ(sample.time, to_sample_time(last - (39 - i) * period)) << i;
    }
}

TEST(SampleTimingTest, TheLineTakesTheUsualTimeIfItsSpeedIsNotKnown) {
    const SampleTiming unknown{AnswerType::normal, {.sample_duration = microseconds{504}}};
    const SampleTiming known{
        AnswerType::normal,
        {.sample_duration = microseconds{504}, .baud = 115200}};
    EXPECT_EQ(unknown.last_sample(at(0)), at(0) - microseconds{504 + 252 + 434});
    EXPECT_EQ(known.last_sample(at(0)), unknown.last_sample(at(0)));
}

TEST(SampleTimingTest, SurvivesDurationsThatNoScannerHas) {
    const SampleTiming endless{
        AnswerType::express,
        {.sample_duration = nanoseconds::max(), .baud = 1, .ethernet = false}};
    EXPECT_EQ(endless.sample_duration(), microseconds{1'000'000});
    EXPECT_EQ(endless.last_sample(at(0)), at(0) - microseconds{1'500'000 + 840'000'000});
    const SampleTiming negative{
        AnswerType::express,
        {.sample_duration = nanoseconds::min(), .baud = 0, .ethernet = true}};
    EXPECT_EQ(negative.sample_duration(), microseconds{0});
    const SampleTiming tiny{AnswerType::dense, {.sample_duration = nanoseconds{15}}};
    EXPECT_EQ(tiny.sample_duration(), nanoseconds{0});
}

}  // namespace
}  // namespace sweepcast::protocol
