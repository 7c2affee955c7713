// Scans on file, for readers in every language: what the vendor's decoder gave, as a Scan message.
// With SWEEPCAST_WRITE_SCANS in the environment they are written anew instead.
#include "driver/protocol/decode.hpp"
#include "server/frame/frame_content.hpp"
#include "server/frame/scan_columns.hpp"
#include "sweepcast/v1/scan.pb.h"
#include "tests/support/vector.hpp"

#include <boost/json.hpp>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

namespace sweepcast::frame {
namespace {

constexpr std::size_t first = 50;
constexpr std::size_t count = 400;

std::string path_of(const std::string& name) {
    return std::string(SWEEPCAST_VECTORS) + "/scans/" + name + ".json";
}

std::vector<protocol::Sample> slice_of(const test::Vector& vector) {
    auto decoder = protocol::Decoder::create(vector.type, vector.settings).value();
    protocol::Decoded decoded;
    decoder.push(vector.bytes, {}, decoded);
    auto samples = std::span(decoded.samples).subspan(first, count);
    std::int64_t us = 1'000'000;
    for (auto& sample : samples) {
        sample.time = protocol::SampleTime(std::chrono::microseconds(us));
        us += 250 + us % 7;
    }
    return {samples.begin(), samples.end()};
}

std::string to_hex(const std::string& bytes) {
    constexpr const char* digits = "0123456789abcdef";
    std::string hex;
    for (const char c : bytes) {
        const auto byte = static_cast<unsigned char>(c);
        hex += digits[byte >> 4U];
        hex += digits[byte & 15U];
    }
    return hex;
}

class ScanVectorTest : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(
    Types,
    ScanVectorTest,
    testing::Values("81_room", "82_room", "83_room", "84_room", "85_room", "86_room"),
    [](const auto& test) { return "answers_" + test.param; }
);

TEST_P(ScanVectorTest, IsWhatTheEncoderMakes) {
    const auto vector = test::load_vector(GetParam());
    const auto samples = slice_of(vector);
    FrameContent content;
    content.samples = samples;
    content.answer_type = vector.type;
    content.mode = "Vector";
    v1::Scan scan;
    to_columns(content, {}, scan);
    const boost::json::value made = {
        {"vector", GetParam()},
        {"first", first},
        {"count", count},
        {"scan", to_hex(scan.SerializeAsString())}};
    if (std::getenv("SWEEPCAST_WRITE_SCANS") != nullptr) {
        std::ofstream(path_of(GetParam())) << made << "\n";
        return;
    }
    std::ifstream file(path_of(GetParam()));
    const std::string text(std::istreambuf_iterator<char>(file), {});
    // A change here is one of the promise to every reader.
    EXPECT_EQ(boost::json::parse(text), made);
    EXPECT_EQ(from_columns(scan).value().sweep.samples, samples);
}

}  // namespace
}  // namespace sweepcast::frame
