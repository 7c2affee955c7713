// Headers of captures, written and read, true and made up.
#include "driver/capture/capture_header.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace sweepcast::capture {
namespace {

using namespace std::chrono_literals;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

CaptureHeader full_header() {
    return {
        .program = "sweepcast 0.1.0",
        .started = "2026-01-31T12:00:00.000Z",
        .model = "A3M1-R1",
        .model_id = 0x31,
        .serial = "0123456789ABCDEF0123456789ABCDEF",
        .firmware = "1.29",
        .hardware = 7,
        .mode = "Sensitivity",
        .mode_id = 3,
        .answer_type = protocol::AnswerType::ultra,
        .sample_duration = 62'890ns,
        .baud = 256000};
}

TEST(CaptureHeaderTest, IsReadAsItWasWritten) {
    const auto text = to_json(full_header());
    EXPECT_THAT(text, Not(HasSubstr("\n")));
    const auto read = header_from_json(text);
    ASSERT_TRUE(read) << read.error().cause;
    EXPECT_EQ(*read, full_header());
}

TEST(CaptureHeaderTest, NeedsOnlyWhatDecodingNeeds) {
    const auto read = header_from_json(R"({"answer_type":129,"sample_ns":0,"baud":0,"more":[1]})");
    ASSERT_TRUE(read) << read.error().cause;
    EXPECT_EQ(read->answer_type, protocol::AnswerType::normal);
    EXPECT_EQ(read->model, "");
    EXPECT_FALSE(read->mode_id);
}

TEST(CaptureHeaderTest, MakesTextsPrintable) {
    auto header = full_header();
    header.mode = "Sensi\x1B[2J\ntivity";
    const auto read = header_from_json(to_json(header));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->mode, "Sensi\\u001b[2J\\ntivity");
}

TEST(CaptureHeaderTest, OfALongTextTheBeginningIsKept) {
    auto header = full_header();
    header.mode = std::string(5000, 'x');
    const auto read = header_from_json(to_json(header));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->mode, std::string(256, 'x'));
}

TEST(CaptureHeaderTest, ALongTextIsCutBetweenCharacters) {
    auto header = full_header();
    header.mode = std::string(255, 'x') + "é";
    header.model = std::string(5000, '\x1b');
    const auto read = header_from_json(to_json(header));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->mode, std::string(255, 'x'));
    EXPECT_THAT(read->model, EndsWith("\\u001b"));
    EXPECT_LE(read->model.size(), 256U);
}

class BadHeaderTest : public testing::TestWithParam<const char*> {};

TEST_P(BadHeaderTest, IsRefused) {
    const auto read = header_from_json(GetParam());
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().cause, HasSubstr("header of the capture is damaged"));
    EXPECT_FALSE(read.error().hint.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Texts,
    BadHeaderTest,
    testing::Values(
        "",
        "{",
        "[]",
        "{}",
        R"({"answer_type":129,"sample_ns":0})",
        R"({"answer_type":129,"baud":0})",
        R"({"answer_type":128,"sample_ns":0,"baud":0})",
        R"({"answer_type":385,"sample_ns":0,"baud":0})",
        R"({"answer_type":-127,"sample_ns":0,"baud":0})",
        R"({"answer_type":"0x81","sample_ns":0,"baud":0})",
        R"({"answer_type":129,"sample_ns":-1,"baud":0})",
        R"({"answer_type":129,"sample_ns":1000000001,"baud":0})",
        R"({"answer_type":129,"sample_ns":1e300,"baud":0})",
        R"({"answer_type":129,"sample_ns":0,"baud":4294967296})"
    )
);

TEST(CaptureHeaderTest, IsNotNestedWithoutEnd) {
    EXPECT_FALSE(header_from_json(std::string(10'000, '[')));
}

}  // namespace
}  // namespace sweepcast::capture
