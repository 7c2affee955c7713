// Frames: sweep -> bytes -> sweep, and what comes of bytes that were damaged or made up.
#include "server/frame/dictionary.hpp"
#include "server/frame/error.hpp"
#include "server/frame/frame_decoder.hpp"
#include "server/frame/frame_encoder.hpp"
#include "sweepcast/v1/scan.pb.h"
#include "sweepcast/v1/stream.pb.h"
#include "tests/server/frame/random_sweep.hpp"

#include <gtest/gtest.h>
#include <zstd.h>

#include <string>

namespace sweepcast::frame {
namespace {

v1::Frame frame_in(const WireMessage& wire) {
    v1::ServerMessage message;
    if (!message.ParseFromArray(wire.message().data(), static_cast<int>(wire.message().size())) ||
        !message.has_frame()) {
        throw std::runtime_error("not a frame");
    }
    return message.frame();
}

v1::Frame frame_of_a_room(Compression compression) {
    std::mt19937_64 random(7);  // NOLINT(cert-msc51-cpp): the same sweep in every run
    const auto captured = sweep_of_a_room({.samples = 60}, random);
    FrameEncoder encoder;
    return frame_in(*encoder.encode(whole_sweep(captured), {.compression = compression}));
}

class FrameTest : public testing::TestWithParam<Compression> {};

INSTANTIATE_TEST_SUITE_P(
    Compressions,
    FrameTest,
    testing::Values(Compression::zstd, Compression::none),
    [](const auto& test) { return test.param == Compression::zstd ? "zstd" : "none"; }
);

TEST_P(FrameTest, BringsBackThousandsOfRandomSweeps) {
    std::mt19937_64 random(20251122);  // NOLINT(cert-msc51-cpp): the same sweeps in every run
    FrameEncoder encoder;
    FrameDecoder decoder;
    for (int i = 0; i < 2000; ++i) {
        const auto captured = random_sweep(random);
        const auto frame =
            frame_in(*encoder.encode(whole_sweep(captured), {.compression = GetParam()}));
        ASSERT_EQ(frame.lidar(), captured.lidar);
        ASSERT_EQ(frame.sequence(), captured.sequence);
        const auto decoded = decoder.decode(frame);
        ASSERT_TRUE(decoded.has_value()) << i << ": " << decoded.error().message();
        ASSERT_EQ(decoded->sweep, captured.sweep) << i;
    }
}

TEST_P(FrameTest, BringsBackTheLargestSweep) {
    std::mt19937_64 random(3);  // NOLINT(cert-msc51-cpp): the same sweep in every run
    device::CapturedSweep captured;
    captured.sweep.samples.resize(max_samples);
    for (auto& sample : captured.sweep.samples) {
        sample.time = protocol::SampleTime(
            std::chrono::microseconds(static_cast<std::int64_t>(random() >> 22U))
        );
        sample.distance.raw = random() % 2 == 0 ? 1 : 0xFFFFFFFF;
        sample.angle.raw = static_cast<std::uint16_t>(random());
        sample.quality = static_cast<std::uint8_t>(random());
        sample.flag = static_cast<std::uint8_t>(random());
    }
    FrameEncoder encoder;
    FrameDecoder decoder;
    EXPECT_EQ(
        decoder
            .decode(frame_in(*encoder.encode(whole_sweep(captured), {.compression = GetParam()})))
            .value()
            .sweep,
        captured.sweep
    );
}

TEST_P(FrameTest, EncodesTheSameSweepToTheSameBytes) {
    std::mt19937_64 random(7);  // NOLINT(cert-msc51-cpp): the same sweeps in every run
    FrameEncoder used;
    const auto captured = random_sweep(random);
    (void)used.encode(whole_sweep(random_sweep(random)), {.compression = Compression::zstd});
    (void)used.encode(whole_sweep(random_sweep(random)), {.compression = Compression::none});
    const auto after_others = used.encode(whole_sweep(captured), {.compression = GetParam()});
    const auto at_first = FrameEncoder().encode(whole_sweep(captured), {.compression = GetParam()});
    const auto a = after_others->message();
    const auto b = at_first->message();
    EXPECT_EQ(
        std::vector<std::uint8_t>(a.begin(), a.end()),
        std::vector<std::uint8_t>(b.begin(), b.end())
    );
}

TEST_P(FrameTest, RefusesEveryTruncatedBody) {
    const auto whole = frame_of_a_room(GetParam());
    FrameDecoder decoder;
    for (std::size_t size = 0; size < whole.body().size(); ++size) {
        auto frame = whole;
        frame.mutable_body()->resize(size);
        EXPECT_TRUE(decoder.decode(frame).has_error()) << size;
    }
}

TEST_P(FrameTest, SurvivesEveryFlippedBitAndDecodesTheNextFrame) {
    const auto whole = frame_of_a_room(GetParam());
    FrameDecoder decoder;
    const auto expected = decoder.decode(whole).value().sweep;
    for (std::size_t bit = 0; bit < whole.body().size() * 8; ++bit) {
        auto frame = whole;
        auto& byte = (*frame.mutable_body())[bit / 8];
        byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1U << (bit % 8)));
        const auto decoded = decoder.decode(frame);
        if (decoded.has_value(
            )) {  // without a checksum some damage stays unseen, but never a sample too many
            EXPECT_LE(decoded->sweep.samples.size(), max_samples);
        } else {
            EXPECT_EQ(decoded.error().category(), frame_category()) << bit;
        }
    }
    EXPECT_EQ(decoder.decode(whole).value().sweep, expected);
}

TEST_P(FrameTest, RefusesAWrongSize) {
    auto frame = frame_of_a_room(GetParam());
    frame.set_raw_size(frame.raw_size() - 1);
    EXPECT_EQ(FrameDecoder().decode(frame).error(), errc::raw_size_wrong);
    frame.set_raw_size(frame.raw_size() + 2);
    EXPECT_EQ(FrameDecoder().decode(frame).error(), errc::raw_size_wrong);
}

TEST_P(FrameTest, RefusesASizeBeyondTheLimitWhateverTheBodySays) {
    auto frame = frame_of_a_room(GetParam());
    frame.set_raw_size(max_raw_size + 1);
    EXPECT_EQ(FrameDecoder().decode(frame).error(), errc::raw_size_out_of_range);
}

TEST(ZstdFrame, ComesBackThroughTheDictionaryAndSaysWhichItWas) {
    std::mt19937_64 random(7);  // NOLINT(cert-msc51-cpp): the same sweep in every run
    const auto captured = sweep_of_a_room({.samples = 60}, random);
    const auto content = whole_sweep(captured);
    FrameEncoder encoder;
    const auto frame = frame_in(*encoder.encode(content, {.dictionary = true}));
    EXPECT_EQ(frame.dictionary(), dictionary_id());
    EXPECT_LT(frame.body().size(), frame_in(*encoder.encode(content, {})).body().size());
    EXPECT_EQ(FrameDecoder().decode(frame).value().sweep, captured.sweep);
}

TEST(ZstdFrame, RefusesADictionaryThatIsNotOurs) {
    std::mt19937_64 random(7);  // NOLINT(cert-msc51-cpp): the same sweep in every run
    const auto captured = sweep_of_a_room({.samples = 60}, random);
    auto frame = frame_in(*FrameEncoder().encode(whole_sweep(captured), {.dictionary = true}));
    frame.set_dictionary(dictionary_id() + 1);
    EXPECT_EQ(FrameDecoder().decode(frame).error(), errc::dictionary_unknown);
    frame.set_dictionary(0);
    EXPECT_EQ(FrameDecoder().decode(frame).error(), errc::compression_damaged);
}

TEST(ZstdFrame, StaysUncompressedWhereThatIsSmaller) {
    device::CapturedSweep captured;
    captured.sweep.samples.resize(1);
    const auto frame = frame_in(*FrameEncoder().encode(whole_sweep(captured), {}));
    EXPECT_EQ(frame.compression(), v1::NONE);
    EXPECT_EQ(frame.body().size(), frame.raw_size());
    EXPECT_EQ(FrameDecoder().decode(frame).value().sweep, captured.sweep);
}

v1::Frame zstd_frame(const std::string& raw, std::uint32_t announced) {
    v1::Frame frame;
    frame.set_raw_size(announced);
    frame.mutable_body()->resize(ZSTD_compressBound(raw.size()));
    frame.mutable_body()->resize(
        ZSTD_compress(frame.mutable_body()->data(), frame.body().size(), raw.data(), raw.size(), 1)
    );
    return frame;
}

TEST(ZstdFrame, RefusesABombThatAnnouncesItsSize) {
    const std::string zeros(64 << 20, '\0');
    EXPECT_EQ(
        FrameDecoder().decode(zstd_frame(zeros, 64 << 20)).error(),
        errc::raw_size_out_of_range
    );
    EXPECT_EQ(FrameDecoder().decode(zstd_frame(zeros, 100)).error(), errc::raw_size_wrong);
}

TEST(ZstdFrame, RefusesASecondFrameBehindTheFirst) {
    auto frame = frame_of_a_room(Compression::zstd);
    frame.mutable_body()->append(zstd_frame(std::string(1000, 'x'), 0).body());
    EXPECT_EQ(FrameDecoder().decode(frame).error(), errc::compression_damaged);
}

TEST(ZstdFrame, RefusesABodyThatIsNoZstd) {
    auto frame = frame_of_a_room(Compression::none);
    frame.set_compression(v1::ZSTD);
    EXPECT_EQ(FrameDecoder().decode(frame).error(), errc::compression_damaged);
}

TEST(ZstdFrame, RefusesABodyThatIsNoScan) {
    const std::string nonsense(100, '\xFF');
    EXPECT_EQ(FrameDecoder().decode(zstd_frame(nonsense, 100)).error(), errc::scan_malformed);
}

TEST(ZstdFrame, RefusesACompressionThatIsNotKnown) {
    auto frame = frame_of_a_room(Compression::none);
    frame.set_compression(static_cast<v1::Compression>(7));
    EXPECT_EQ(FrameDecoder().decode(frame).error(), errc::compression_unknown);
}

}  // namespace
}  // namespace sweepcast::frame
