// The streams in a capture, told apart by descriptors and requests.
#include "driver/capture/stream_finder.hpp"

#include "driver/protocol/descriptor_hunter.hpp"
#include "driver/protocol/request.hpp"

#include <gtest/gtest.h>

namespace sweepcast::capture {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;
using protocol::AnswerType;

CaptureRecord from_device(Bytes bytes) {
    return {Direction::from_device, 7ns, std::move(bytes)};
}

CaptureRecord to_device(const protocol::Request& request) {
    return {Direction::to_device, 7ns, protocol::encode(request)};
}

Bytes descriptor(AnswerType type) {
    const auto bytes = protocol::encode_descriptor(
        {static_cast<std::uint32_t>(protocol::packet_size(type)),
         true,
         static_cast<std::uint8_t>(type)}
    );
    return {bytes.begin(), bytes.end()};
}

Bytes joined(Bytes first, const Bytes& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

Bytes copy(const std::optional<StreamBlock>& block) {
    return {block->bytes.begin(), block->bytes.end()};
}

TEST(StreamFinderTest, GivesWhatFollowsTheDescriptor) {
    StreamFinder finder;
    const auto first = from_device(joined(joined({1, 2}, descriptor(AnswerType::dense)), {3, 4}));
    const auto block = finder.push(first);
    ASSERT_TRUE(block);
    EXPECT_TRUE(block->begins);
    EXPECT_EQ(block->type, AnswerType::dense);
    EXPECT_EQ(block->at, 7ns);
    EXPECT_EQ(copy(block), (Bytes{3, 4}));
    const auto second = from_device({5});
    const auto more = finder.push(second);
    ASSERT_TRUE(more);
    EXPECT_FALSE(more->begins);
    EXPECT_EQ(copy(more), Bytes{5});
}

TEST(StreamFinderTest, FindsADescriptorInPieces) {
    StreamFinder finder;
    const auto bytes = descriptor(AnswerType::normal);
    for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
        EXPECT_FALSE(finder.push(from_device({bytes[i]})));
    }
    const auto last = from_device({bytes.back()});
    const auto block = finder.push(last);
    ASSERT_TRUE(block);
    EXPECT_TRUE(block->begins);
    EXPECT_TRUE(block->bytes.empty());
}

TEST(StreamFinderTest, EndsAStreamWithARequest) {
    StreamFinder finder;
    ASSERT_TRUE(finder.push(from_device(descriptor(AnswerType::normal))));
    EXPECT_FALSE(finder.push(to_device({protocol::Command::stop, {}})));
    EXPECT_FALSE(finder.push(from_device({1, 2, 3})));
    const auto next = from_device(descriptor(AnswerType::express));
    const auto block = finder.push(next);
    ASSERT_TRUE(block);
    EXPECT_TRUE(block->begins);
    EXPECT_EQ(block->type, AnswerType::express);
}

TEST(StreamFinderTest, GoesOnWhileTheMotorIsSpokenTo) {
    StreamFinder finder;
    ASSERT_TRUE(finder.push(from_device(descriptor(AnswerType::normal))));
    EXPECT_FALSE(finder.push(to_device({protocol::Command::motor_rpm, {0x58, 0x02}})));
    EXPECT_FALSE(finder.push(to_device({protocol::Command::set_motor_pwm, {0x94, 0x02}})));
    const auto more = from_device({1});
    ASSERT_TRUE(finder.push(more));
}

}  // namespace
}  // namespace sweepcast::capture
