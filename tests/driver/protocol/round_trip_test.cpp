// What the encoders write, the decoders read: over random content, and at the limits of every
// field.
#include "driver/protocol/encode_express.hpp"
#include "driver/protocol/encode_normal.hpp"
#include "tests/driver/protocol/decoding.hpp"

#include <gtest/gtest.h>

namespace sweepcast::protocol {
namespace {

template <class Packet>
void append(Bytes& bytes, const Packet& packet) {
    bytes.insert(bytes.end(), packet.begin(), packet.end());
}

TEST(NormalRoundTripTest, EveryMeasurementComesBack) {
    std::mt19937 random(81);
    std::vector<NormalMeasurement> measurements;
    Bytes bytes;
    for (int i = 0; i < 5000; ++i) {
        measurements.push_back(
            {.starts_revolution = random() % 8 == 0,
             .quality6 = static_cast<std::uint8_t>(random() % 64),
             .angle = {static_cast<std::uint16_t>(random() % 23040)},
             .distance_q2 = static_cast<std::uint16_t>(random())}
        );
        append(bytes, encode_normal(measurements.back()));
    }
    const auto decoded = decode_whole(AnswerType::normal, bytes);
    ASSERT_EQ(decoded.samples.size(), measurements.size());
    EXPECT_TRUE(decoded.events.empty());
    for (std::size_t i = 0; i < measurements.size(); ++i) {
        const auto& expected = measurements[i];
        const auto& sample = decoded.samples[i];
        ASSERT_EQ(sample.starts_revolution(), expected.starts_revolution) << i;
        ASSERT_EQ(sample.quality, expected.quality6 * 4) << i;
        ASSERT_EQ(sample.angle.raw, expected.angle.raw * 256 / 90) << i;
        ASSERT_EQ(sample.distance.raw, expected.distance_q2) << i;
    }
}

TEST(NormalRoundTripTest, ValuesAreCutToTheirFields) {
    const auto packet = encode_normal(
        {.starts_revolution = false, .quality6 = 0xFF, .angle = {0xFFFF}, .distance_q2 = 0xFFFF}
    );
    EXPECT_EQ(packet, (std::array<std::uint8_t, 5>{0xFE, 0xFF, 0xFF, 0xFF, 0xFF}));
}

class ExpressRoundTripTest : public testing::Test {
protected:
    ExpressCapsule random_capsule(std::uint16_t start_q6) {
        ExpressCapsule capsule{.restart = false, .start_angle = {start_q6}, .samples = {}};
        for (auto& sample : capsule.samples) {
            sample.distance_mm = static_cast<std::uint16_t>(random_() % 16384);
            sample.angle_offset_q3 = static_cast<std::uint8_t>(random_() % 64);
        }
        return capsule;
    }

    std::mt19937 random_{82};
};

TEST_F(ExpressRoundTripTest, EverySampleComesBackOnceTheNextCapsuleIsIn) {
    constexpr unsigned turned_q6 =
        1280;  // 20 degrees in a capsule, 5/8 of one from sample to sample
    std::vector<ExpressCapsule> capsules;
    Bytes bytes;
    for (unsigned i = 0; i < 300; ++i) {
        capsules.push_back(random_capsule(static_cast<std::uint16_t>(i * turned_q6 % 23040)));
        append(bytes, encode_express(capsules.back()));
    }
    const auto decoded = decode_whole(AnswerType::express, bytes);
    ASSERT_EQ(decoded.samples.size(), (capsules.size() - 1) * 32);
    EXPECT_TRUE(decoded.events.empty());
    for (std::size_t i = 0; i < decoded.samples.size(); ++i) {
        const auto& capsule = capsules[i / 32];
        const auto& expected = capsule.samples[i % 32];
        const auto& sample = decoded.samples[i];
        const int angle_q6 = (capsule.start_angle.raw + static_cast<int>(i % 32) * 40 -
                              expected.angle_offset_q3 * 8 + 23040) %
                             23040;
        ASSERT_EQ(sample.distance.raw, expected.distance_mm * 4U) << i;
        ASSERT_EQ(sample.angle.raw, angle_q6 * 256 / 90) << i;
        ASSERT_EQ(sample.quality, expected.distance_mm != 0 ? 188 : 0) << i;
    }
}

TEST_F(ExpressRoundTripTest, ARestartDropsTheCapsuleBeforeAndIsTold) {
    Bytes bytes;
    auto restarted = random_capsule(2560);
    restarted.restart = true;
    append(bytes, encode_express(random_capsule(0)));
    append(bytes, encode_express(random_capsule(1280)));
    append(bytes, encode_express(restarted));
    append(bytes, encode_express(random_capsule(3840)));
    const auto decoded = decode_whole(AnswerType::express, bytes);
    EXPECT_EQ(decoded.samples.size(), 64U);
    EXPECT_EQ(
        decoded.events,
        (std::vector<DecodeEvent>{
            {32, DecodeEventKind::encoder_reset},
            {32, DecodeEventKind::scan_reset}})
    );
}

TEST_F(ExpressRoundTripTest, ValuesAreCutToTheirFields) {
    ExpressCapsule capsule{.restart = true, .start_angle = {0xFFFF}, .samples = {}};
    capsule.samples.fill({.distance_mm = 0xFFFF, .angle_offset_q3 = 0xFF});
    const auto packet = encode_express(capsule);
    // All bits of the content are set: 82 bytes of FF, whose XOR is 0.
    EXPECT_EQ(packet[0], 0xA0);
    EXPECT_EQ(packet[1], 0x50);
    EXPECT_TRUE(std::all_of(packet.begin() + 2, packet.end(), [](auto byte) {
        return byte == 0xFF;
    }));
}

}  // namespace
}  // namespace sweepcast::protocol
