// Lengths in front of messages, written and read, cut anywhere, and lied about.
#include "server/frame/message_framing.hpp"

#include "server/frame/error.hpp"

#include <gtest/gtest.h>

#include <string>

namespace sweepcast::frame {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes delimited(const Bytes& message) {
    Bytes out;
    append_delimited(out, message);
    return out;
}

/// The next message as bytes of its own.
std::optional<Bytes> take(DelimitedReader& reader) {
    const auto message = reader.next().value();
    return message ? std::optional(Bytes(message->begin(), message->end())) : std::nullopt;
}

struct LengthCase {
    std::string name;
    std::uint32_t length;
    Bytes expected;
};

class LengthTest : public testing::TestWithParam<LengthCase> {};

TEST_P(LengthTest, IsWrittenAsAVarint) {
    Bytes out;
    append_length(out, GetParam().length);
    EXPECT_EQ(out, GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    Lengths,
    LengthTest,
    testing::Values(
        LengthCase{"zero", 0, {0}},
        LengthCase{"longest_of_one_byte", 127, {0x7F}},
        LengthCase{"shortest_of_two_bytes", 128, {0x80, 0x01}},
        LengthCase{"as_in_protobufs_documentation", 150, {0x96, 0x01}},
        LengthCase{"longest", 0xFFFFFFFF, {0xFF, 0xFF, 0xFF, 0xFF, 0x0F}}
    ),
    [](const auto& test) { return test.param.name; }
);

TEST(DelimitedReader, GivesBackWhatWasAppended) {
    Bytes stream = delimited({1, 2, 3});
    append_delimited(stream, {});
    append_delimited(stream, Bytes(300, 7));
    DelimitedReader reader(1000);
    reader.push(stream);
    EXPECT_EQ(take(reader), (Bytes{1, 2, 3}));
    EXPECT_EQ(take(reader), Bytes{});
    EXPECT_EQ(take(reader), Bytes(300, 7));
    EXPECT_EQ(take(reader), std::nullopt);
}

TEST(DelimitedReader, GivesTheSameOneByteAtATime) {
    Bytes stream = delimited({1, 2, 3});
    append_delimited(stream, {});
    append_delimited(stream, Bytes(300, 7));
    DelimitedReader reader(1000);
    std::vector<Bytes> messages;
    for (const std::uint8_t byte : stream) {
        reader.push({&byte, 1});
        while (auto message = take(reader)) {
            messages.push_back(*message);
        }
    }
    EXPECT_EQ(messages, (std::vector<Bytes>{{1, 2, 3}, {}, Bytes(300, 7)}));
}

TEST(DelimitedReader, NeedsMoreForEveryPrefixOfAMessage) {
    const Bytes stream = delimited(Bytes(200, 7));
    for (std::size_t size = 0; size < stream.size(); ++size) {
        DelimitedReader reader(1000);
        reader.push(std::span(stream).first(size));
        EXPECT_EQ(take(reader), std::nullopt) << size;
    }
}

TEST(DelimitedReader, AcceptsTheLongestMessageAndNoLonger) {
    DelimitedReader reader(300);
    reader.push(delimited(Bytes(300, 7)));
    EXPECT_EQ(take(reader), Bytes(300, 7));
    reader.push(delimited(Bytes(301, 7)));
    EXPECT_EQ(reader.next().error(), errc::message_too_long);
}

TEST(DelimitedReader, RefusesALengthBeforeItsMessageComes) {
    DelimitedReader reader(300);
    reader.push(Bytes{0xFF, 0xFF, 0xFF, 0xFF, 0x0F});
    EXPECT_EQ(reader.next().error(), errc::message_too_long);
}

TEST(DelimitedReader, RefusesALengthBeforeItIsComplete) {
    DelimitedReader reader(300);
    reader.push(Bytes{0xFF, 0xFF});
    EXPECT_EQ(reader.next().error(), errc::message_too_long);
}

struct MalformedCase {
    std::string name;
    Bytes bytes;
};

class MalformedLengthTest : public testing::TestWithParam<MalformedCase> {};

TEST_P(MalformedLengthTest, IsRefusedForGood) {
    DelimitedReader reader(0xFFFFFFFF);
    reader.push(GetParam().bytes);
    EXPECT_EQ(reader.next().error(), errc::length_malformed);
    reader.push(delimited({1}));
    EXPECT_EQ(reader.next().error(), errc::length_malformed);
}

INSTANTIATE_TEST_SUITE_P(
    Lengths,
    MalformedLengthTest,
    testing::Values(
        MalformedCase{"zero_in_two_bytes", {0x80, 0x00}},
        MalformedCase{"five_in_two_bytes", {0x85, 0x00}},
        MalformedCase{"zero_in_five_bytes", {0x80, 0x80, 0x80, 0x80, 0x00}},
        MalformedCase{"six_bytes", {0x80, 0x80, 0x80, 0x80, 0x80, 0x00}},
        MalformedCase{"without_end", Bytes(20, 0x80)}
    ),
    [](const auto& test) { return test.param.name; }
);

TEST(FrameError, HasAMessageForEveryValue) {
    for (int value = 1; value <= static_cast<int>(errc::answer_type_unknown); ++value) {
        EXPECT_EQ(
            error_code(value, frame_category()).message().find("unknown frame"),
            std::string::npos
        ) << value;
    }
    EXPECT_EQ(frame_category().name(), std::string("sweepcast.frame"));
}

}  // namespace
}  // namespace sweepcast::frame
