// Damage made to measure: whatever happens to a stream, decoders stay within it, invent nothing and
// recover soon.
#include "driver/protocol/capsule.hpp"
#include "driver/protocol/encode_express.hpp"
#include "driver/protocol/encode_normal.hpp"
#include "tests/driver/protocol/decoding.hpp"
#include "tests/support/vector.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace sweepcast::protocol {
namespace {

/// A copy that owns exactly its bytes, so that a sanitizer sees every read beyond them.
Decoded decode_exact(AnswerType type, const Bytes& bytes) {
    const std::vector<std::uint8_t> exact(bytes);
    return decode_whole(type, exact);
}

std::size_t skipped_bytes(const Decoded& decoded) {
    return std::accumulate(
        decoded.events.begin(),
        decoded.events.end(),
        std::size_t{0},
        [](std::size_t sum, const DecodeEvent& event) {
            return sum + (event.kind == DecodeEventKind::bytes_skipped ? event.count : 0);
        }
    );
}

struct FlippedStream {
    const char* vector;
    std::size_t bytes;            ///< of it are flipped, one bit at a time
    std::size_t dearest_packets;  ///< that one may cost
};

class BitFlipTest : public testing::TestWithParam<FlippedStream> {};

TEST_P(BitFlipTest, ASingleOneCostsNoMoreThanItsNeighbourhood) {
    auto vector = test::load_vector(GetParam().vector);
    vector.bytes.resize(GetParam().bytes);
    const auto clean = decode_exact(vector.type, vector.bytes).samples.size();
    const auto dearest = GetParam().dearest_packets * samples_per_packet(vector.type);
    for (std::size_t bit = 0; bit < vector.bytes.size() * 8; ++bit) {
        auto damaged = vector.bytes;
        damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ 1U << bit % 8);
        const auto decoded = decode_exact(vector.type, damaged);
        ASSERT_LE(decoded.samples.size(), clean) << "bit " << bit;
        ASSERT_GE(decoded.samples.size() + dearest, clean) << "bit " << bit;
    }
}

INSTANTIATE_TEST_SUITE_P(
    Streams,
    BitFlipTest,
    testing::Values(
        FlippedStream{"81_room", 1000, 12},
        FlippedStream{"82_room", 12 * 84, 4},
        FlippedStream{"83_room", 3 * 781, 1},
        FlippedStream{"84_room", 8 * 132, 4},
        FlippedStream{"85_room", 12 * 84, 4},
        FlippedStream{"86_room", 8 * 170, 4}
    ),
    [](const auto& tested) { return std::string("v") + tested.param.vector; }
);

TEST(NormalRoomTest, LittleIsReservedAheadOfAPacketThatFails) {
    Bytes bytes;
    for (std::uint16_t i = 0; i < 20; ++i) {
        NormalMeasurement measurement;
        measurement.starts_revolution = i == 0;
        measurement.angle = AngleQ6{static_cast<std::uint16_t>(i * 64)};
        const auto packet = encode_normal(measurement);
        bytes.insert(bytes.end(), packet.begin(), packet.end());
    }
    bytes.resize(1'000'000);
    const auto decoded = decode_whole(AnswerType::normal, bytes);
    EXPECT_GE(decoded.samples.size(), 10U);
    EXPECT_LT(decoded.samples.capacity(), 1000U);
}

class NoiseTest : public testing::TestWithParam<AnswerType> {};

Bytes random_noise() {
    std::mt19937 random(7);
    Bytes noise(200'000);
    for (auto& byte : noise) {
        byte = static_cast<std::uint8_t>(random());
    }
    return noise;
}

TEST_P(NoiseTest, IsReportedTheSameHoweverItIsCut) {
    const auto noise = random_noise();
    const auto whole = decode_whole(GetParam(), noise);
    for (const std::size_t size : {1U, 100U, 512U, 3000U}) {
        const auto cut = decode_in_pieces(GetParam(), {}, noise, [&] { return size; });
        EXPECT_EQ(cut.samples, whole.samples) << size;
        EXPECT_EQ(cut.events, whole.events) << size;
    }
}

TEST_P(NoiseTest, LongNoiseGivesNextToNoSamplesAndIsReported) {
    const auto noise = random_noise();
    const auto decoded = decode_whole(GetParam(), noise);
    // Two check bits every five bytes: a false alignment once in some ten thousand bytes is what
    // they allow.
    EXPECT_LE(decoded.samples.size(), GetParam() == AnswerType::normal ? 400U : 0U);
    EXPECT_GE(skipped_bytes(decoded), noise.size() * 95 / 100);
}

TEST_P(NoiseTest, EverySinglyRepeatedByteIsSurvived) {
    for (unsigned value = 0; value < 256; ++value) {
        const Bytes bytes(3000, static_cast<std::uint8_t>(value));
        const auto decoded = decode_exact(GetParam(), bytes);
        ASSERT_LE(
            decoded.samples.size(),
            bytes.size() / packet_size(GetParam()) * samples_per_packet(GetParam())
        );
    }
}

INSTANTIATE_TEST_SUITE_P(
    Types,
    NoiseTest,
    testing::Values(
        AnswerType::normal,
        AnswerType::express,
        AnswerType::hq,
        AnswerType::ultra,
        AnswerType::dense,
        AnswerType::ultra_dense
    ),
    [](const auto& tested) { return "type" + std::to_string(static_cast<int>(tested.param)); }
);

/// A turning scanner's stream as packets; sample distances count up, so that each sample tells its
/// place.
std::vector<Bytes> normal_stream(unsigned count) {
    std::vector<Bytes> packets;
    for (unsigned i = 0; i < count; ++i) {
        const auto packet = encode_normal(
            {.starts_revolution = i % 240 == 0,
             .quality6 = 15,
             .angle = {static_cast<std::uint16_t>(i * 96 % 23040)},
             .distance_q2 = static_cast<std::uint16_t>(i * 4)}
        );
        packets.emplace_back(packet.begin(), packet.end());
    }
    return packets;
}

std::vector<Bytes> express_stream(unsigned count) {
    std::vector<Bytes> packets;
    for (unsigned i = 0; i < count; ++i) {
        ExpressCapsule capsule{
            .restart = i == 0,
            .start_angle = {static_cast<std::uint16_t>(i * 1333 % 23040)},
            .samples = {}};
        for (unsigned k = 0; k < 32; ++k) {
            capsule.samples[k] = {
                static_cast<std::uint16_t>((i * 32 + k) % 16384),
                static_cast<std::uint8_t>(k % 8)};
        }
        const auto packet = encode_express(capsule);
        packets.emplace_back(packet.begin(), packet.end());
    }
    return packets;
}

/// The packets end to end, with `count` bytes lost from offset `at` of packet `damaged`.
Bytes join_with_loss(
    const std::vector<Bytes>& packets,
    std::size_t damaged,
    std::size_t at,
    std::size_t count
) {
    Bytes bytes;
    for (const auto& packet : packets) {
        bytes.insert(bytes.end(), packet.begin(), packet.end());
    }
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(damaged * packets[0].size() + at);
    bytes.erase(from, from + static_cast<std::ptrdiff_t>(count));
    return bytes;
}

/// The places (see normal_stream) of the samples that came out.
std::vector<std::uint32_t> places(const Decoded& decoded) {
    std::vector<std::uint32_t> result;
    for (const auto& sample : decoded.samples) {
        result.push_back(sample.distance.raw / 4);
    }
    return result;
}

/// The places up to `end` without those from `first` up to `last`.
std::vector<std::uint32_t> places_but(std::size_t end, std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> result(end);
    std::iota(result.begin(), result.end(), 0U);
    result.erase(
        result.begin() + static_cast<std::ptrdiff_t>(first),
        result.begin() + static_cast<std::ptrdiff_t>(last)
    );
    return result;
}

TEST(NormalLossTest, LostBytesCostThePacketsTheyBelongToAndAtMostTheOneAfter) {
    constexpr std::size_t damaged = 200;
    const auto packets = normal_stream(400);
    for (std::size_t at = 0; at < 5; ++at) {
        for (std::size_t count = 1; count <= 25; ++count) {
            const auto bytes = join_with_loss(packets, damaged, at, count);
            auto found = places(decode_whole(AnswerType::normal, bytes));
            // A packet that lost bytes of its distance cannot be told from a good one. It comes out
            // with a wrong distance, and takes what it lacks from what follows: the rest of the
            // last packet hit and, if that is too little, the next.
            const auto hit = (at + count + 4) / 5;
            const auto rest = hit * 5 - at - count;
            const bool takes_the_next = at >= 3 && 5 - at > rest;
            const auto expected =
                places_but(400, damaged, damaged + hit + (takes_the_next ? 1U : 0U));
            // Pieces of the packets hit may make up one that passes, with the distance of one of
            // them or a wrong one.
            std::erase_if(found, [&](auto place) {
                return place >= damaged && place < damaged + hit;
            });
            if (found.size() == expected.size() + 1) {
                found.erase(found.begin() + damaged);
            }
            ASSERT_EQ(found, expected) << count << " bytes lost from byte " << at;
        }
    }
}

TEST(ExpressLossTest, LostBytesCostOnlyTheCapsulesTheyBelongToAndAtMostTheOneBefore) {
    const auto packets = express_stream(40);
    for (std::size_t at = 0; at < 84; ++at) {
        for (const std::size_t count : {1U, 2U, 5U, 30U, 83U, 84U, 85U, 168U, 200U}) {
            const auto bytes = join_with_loss(packets, 20, at, count);
            if (intact_capsule(std::span(bytes).subspan(20 * 84, 84))) {
                continue;  // head and tail of two capsules that pass 8 bits of checksum: one in 256
                           // does
            }
            const auto hit = (at + count + 83) / 84;
            const auto decoded = decode_whole(AnswerType::express, bytes);
            const bool sync_follows = bytes[20 * 84] >> 4 == 0xA && bytes[20 * 84 + 1] >> 4 == 0x5;
            // With no sync nibbles after it, nothing shows where the capsule before the loss ended.
            const std::size_t first_lost = sync_follows ? 20 : 19;
            ASSERT_EQ(places(decoded), places_but(39 * 32, first_lost * 32, (20 + hit) * 32))
                << count << " bytes lost from byte " << at;
        }
    }
}

TEST(ExpressLossTest, SamplesBesideALossKeepTheirAngles) {
    const auto packets = express_stream(40);
    const auto clean = decode_whole(AnswerType::express, join_with_loss(packets, 0, 0, 0));
    for (const std::size_t count : {10U, 84U, 168U}) {
        const auto decoded =
            decode_whole(AnswerType::express, join_with_loss(packets, 20, 40, count));
        ASSERT_GT(decoded.samples.size(), 20U * 32);
        for (std::size_t i = 0; i < 20 * 32; ++i) {
            ASSERT_EQ(decoded.samples[i], clean.samples[i]) << "sample " << i << ", lost " << count;
        }
    }
}

TEST(ExpressLossTest, AStreamEnteredInTheMiddleIsInStepWithItsFirstWholeCapsule) {
    const auto packets = express_stream(10);
    for (std::size_t skipped = 1; skipped <= 84; ++skipped) {
        const auto decoded =
            decode_whole(AnswerType::express, join_with_loss(packets, 0, 0, skipped));
        ASSERT_EQ(places(decoded).front(), 32U) << skipped;
        ASSERT_EQ(decoded.samples.size(), 8U * 32) << skipped;
    }
}

TEST(ExpressLossTest, ACapsuleInsideACapsuleIsNotBelieved) {
    // 82_room holds, 31 bytes into its 44th capsule, two sync nibbles and by chance the right
    // checksum.
    const auto vector = test::load_vector("82_room");
    const auto entered_late = std::span(vector.bytes).subspan(43 * 84 + 10);
    const auto decoded = decode_whole(vector.type, entered_late, vector.settings);
    const std::vector<Sample> expected(
        vector.expected.samples.end() - static_cast<std::ptrdiff_t>(decoded.samples.size()),
        vector.expected.samples.end()
    );
    EXPECT_EQ(decoded.samples.size(), (107U - 44U - 1U) * 32U);
    EXPECT_EQ(without_times(decoded.samples), expected);
}

}  // namespace
}  // namespace sweepcast::protocol
