// WireMessage: one set of bytes for both transports.
#include "server/frame/wire_message.hpp"

#include "sweepcast/v1/stream.pb.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace sweepcast::frame {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A message of `text` characters and some more bytes.
v1::ServerMessage message_of(std::size_t text) {
    v1::ServerMessage message;
    message.mutable_closing()->set_reason(std::string(text, 'x'));
    return message;
}

Bytes joined(const FramedBytes& framed) {
    Bytes bytes(framed.head.begin(), framed.head.end());
    bytes.insert(bytes.end(), framed.tail.begin(), framed.tail.end());
    return bytes;
}

/// Such a header, and then the message.
Bytes with_header(Bytes header, const v1::ServerMessage& message) {
    const auto text = message.SerializeAsString();
    header.insert(header.end(), text.begin(), text.end());
    return header;
}

TEST(WireMessage, HoldsTheMessage) {
    const auto message = message_of(200);
    const WireMessage wire(message);
    const auto bytes = wire.message();
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), message.SerializeAsString());
}

TEST(WireMessage, HasItsLengthInFrontOverTcp) {
    const auto message = message_of(200);  // 206 bytes: 0xCE, and one bit more
    ASSERT_EQ(message.ByteSizeLong(), 206U);
    const WireMessage wire(message);
    EXPECT_EQ(joined(wire.framed(Framing::delimited)), with_header({0xCE, 0x01}, message));
    EXPECT_EQ(wire.framed(Framing::delimited).tail.data(), wire.message().data());
}

struct HeaderCase {
    std::size_t size;
    Bytes header;
};

class WebSocketHeaderTest : public testing::TestWithParam<HeaderCase> {};

/// Expected values worked out by hand from RFC 6455, 5.2.
TEST_P(WebSocketHeaderTest, IsThatOfAnUnmaskedBinaryMessageInOneFrame) {
    const auto& [size, header] = GetParam();
    v1::ServerMessage message;
    for (std::size_t text = 0; message.ByteSizeLong() < size; ++text) {
        message = message_of(size < 16 ? text : size - 12 + text);
    }
    ASSERT_EQ(message.ByteSizeLong(), size);
    const WireMessage wire(message);
    const auto framed = wire.framed(Framing::websocket);
    EXPECT_TRUE(framed.tail.empty()) << "is to be sent in one piece";
    EXPECT_EQ(joined(framed), with_header(header, message));
    EXPECT_EQ(wire.size(), framed.size());
}

INSTANTIATE_TEST_SUITE_P(
    Sizes,
    WebSocketHeaderTest,
    testing::Values(
        HeaderCase{5, {0x82, 5}},
        HeaderCase{125, {0x82, 125}},
        HeaderCase{126, {0x82, 126, 0x00, 126}},
        HeaderCase{3000, {0x82, 126, 0x0B, 0xB8}},
        HeaderCase{65535, {0x82, 126, 0xFF, 0xFF}},
        HeaderCase{65536, {0x82, 127, 0, 0, 0, 0, 0, 1, 0, 0}}
    )
);

TEST(WireMessage, OfNothingIsALengthOfZero) {
    const WireMessage wire{v1::ServerMessage()};
    EXPECT_TRUE(wire.message().empty());
    EXPECT_EQ(joined(wire.framed(Framing::delimited)), Bytes{0});
    EXPECT_EQ(joined(wire.framed(Framing::websocket)), (Bytes{0x82, 0}));
}

TEST(FramedBytes, KnowWhatIsLeftAfterAnyNumberOfBytes) {
    const WireMessage wire(message_of(200));
    const auto framed = wire.framed(Framing::delimited);
    const auto whole = joined(framed);
    for (std::size_t sent = 0; sent <= whole.size(); ++sent) {
        EXPECT_EQ(
            joined(framed.after(sent)),
            Bytes(whole.begin() + static_cast<std::ptrdiff_t>(sent), whole.end())
        );
    }
}

}  // namespace
}  // namespace sweepcast::frame
