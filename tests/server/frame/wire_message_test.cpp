// WireMessage: one set of bytes for both transports.
#include "server/frame/wire_message.hpp"

#include "sweepcast/v1/stream.pb.h"

#include <gtest/gtest.h>

namespace sweepcast::frame {
namespace {

TEST(WireMessage, HoldsTheMessageAndItsLengthInFront) {
    v1::ServerMessage message;
    message.mutable_closing()->set_reason(std::string(200, 'x'));
    const WireMessage wire(message);
    const auto bytes = wire.message();
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), message.SerializeAsString());
    ASSERT_EQ(wire.delimited().size(), bytes.size() + 2);
    const std::size_t length =
        (wire.delimited()[0] & 0x7FU) | (std::size_t{wire.delimited()[1]} << 7U);
    EXPECT_EQ(length, bytes.size());
    EXPECT_EQ(wire.delimited().data() + 2, bytes.data());
}

TEST(WireMessage, OfNothingIsALengthOfZero) {
    const WireMessage wire{v1::ServerMessage()};
    EXPECT_TRUE(wire.message().empty());
    ASSERT_EQ(wire.delimited().size(), 1U);
    EXPECT_EQ(wire.delimited()[0], 0);
}

}  // namespace
}  // namespace sweepcast::frame
