// What the gateway says and understands.
#include "server/stream/messages.hpp"

#include "server/frame/dictionary.hpp"
#include "sweepcast/v1/stream.pb.h"
#include "tests/server/stream/known_lidar.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace sweepcast::stream {
namespace {

using testing::HasSubstr;

v1::ServerMessage parse(const frame::WireMessagePtr& wire) {
    v1::ServerMessage message;
    const auto bytes = wire->message();
    EXPECT_TRUE(message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
    return message;
}

class MessagesTest : public testing::Test {
protected:
    MessagesTest() { add_known_lidar(hub); }

    hub::Variants variants;
    hub::LocalHub hub{variants};
};

TEST_F(MessagesTest, HelloTellsVersionLidarsAndDictionaries) {
    const auto message = parse(hello_message(hub));
    ASSERT_TRUE(message.has_hello());
    ASSERT_EQ(message.hello().dictionaries_size(), 1);
    EXPECT_EQ(message.hello().dictionaries(0).id(), frame::dictionary_id());
    EXPECT_EQ(message.hello().dictionaries(0).size(), frame::dictionary_bytes().size());
    EXPECT_EQ(message.hello().protocol_version(), 1U);
    ASSERT_EQ(message.hello().lidars_size(), 1);
    EXPECT_EQ(message.hello().lidars(0).id(), "A0E1C2D3");
}

TEST_F(MessagesTest, StateTellsEverythingKnownOfALidar) {
    const auto lidar = parse(state_message(*known_lidar())).lidar();
    EXPECT_EQ(lidar.state(), v1::Lidar::SCANNING);
    EXPECT_EQ(lidar.device().model(), "A1M8-R6");
    EXPECT_EQ(lidar.device().firmware(), "1.29");
    EXPECT_EQ(lidar.device().serial_number(), "A0E1C2D3000000000000000000000000");
    EXPECT_EQ(lidar.health().status(), v1::Health::WARNING);
    EXPECT_EQ(lidar.health().error_code(), 7U);
    ASSERT_EQ(lidar.modes_size(), 1);
    EXPECT_EQ(lidar.modes(0).samples_per_second(), 4000);
    EXPECT_EQ(lidar.modes(0).answer_type(), 0x82U);
    EXPECT_EQ(lidar.modes(0).max_distance_m(), 12.0);
    EXPECT_TRUE(lidar.modes(0).has_id());
    EXPECT_TRUE(lidar.modes(0).typical());
}

TEST_F(MessagesTest, StateTellsHowFastALidarTurnsAndHowGoodItsLineIs) {
    const auto lidar = parse(state_message(*known_lidar())).lidar();
    EXPECT_EQ(lidar.rotation().control(), v1::Rotation::DUTY);
    EXPECT_EQ(lidar.rotation().wanted_hz(), 7.0);
    EXPECT_EQ(lidar.rotation().measured_hz(), 6.97);
    EXPECT_TRUE(lidar.rotation().settled());
    EXPECT_EQ(lidar.rotation().usual_hz(), 10.0);
    EXPECT_EQ(lidar.rotation().min_hz(), 5.0);
    EXPECT_EQ(lidar.rotation().max_hz(), 15.0);
    EXPECT_EQ(lidar.rotation().warning(), "slow");
    EXPECT_EQ(lidar.line().baud(), 115200U);
    EXPECT_EQ(lidar.line().bytes(), 1000U);
    EXPECT_EQ(lidar.line().samples(), 320U);
    EXPECT_EQ(lidar.line().checksum_errors(), 3U);
    EXPECT_EQ(lidar.line().skipped_bytes(), 2U);
    EXPECT_EQ(lidar.line().lost_packets(), 1U);
}

TEST_F(MessagesTest, ALidarWithoutANameOfItsOwnGoesByItsModel) {
    auto lidar = *known_lidar();
    lidar.state.alias.clear();
    EXPECT_EQ(parse(state_message(lidar)).lidar().device().model(), "A1M8");
}

TEST_F(MessagesTest, ASubscribeBecomesAWish) {
    v1::ClientMessage message;
    message.mutable_subscribe()->set_lidar("A0E1C2D3");
    message.mutable_subscribe()->set_compression(v1::NONE);
    message.mutable_subscribe()->set_request(5);
    const auto order = order_from_message(message.SerializeAsString(), hub);
    ASSERT_TRUE(order);
    ASSERT_TRUE(order->wish);
    EXPECT_EQ(order->wish->lidar, 1U);
    EXPECT_EQ(order->wish->frames.format.compression, frame::Compression::none);
    EXPECT_EQ(order->request, 5U);
    EXPECT_EQ(parse(order->answer).subscribed().wish().request(), 5U);
}

TEST_F(MessagesTest, ASubscribeWithoutALidarWantsAll) {
    v1::ClientMessage message;
    message.mutable_subscribe();
    const auto order = order_from_message(message.SerializeAsString(), hub);
    ASSERT_TRUE(order);
    EXPECT_FALSE(order->wish->lidar);
    EXPECT_EQ(order->wish->frames, frame::Wish{});
}

TEST_F(MessagesTest, AnUnsubscribeWantsNothing) {
    v1::ClientMessage message;
    message.mutable_unsubscribe();
    const auto order = order_from_message(message.SerializeAsString(), hub);
    ASSERT_TRUE(order);
    EXPECT_FALSE(order->wish);
    EXPECT_FALSE(order->answer);
}

TEST_F(MessagesTest, AnUnknownLidarIsRefusedAndTheKnownOnesAreNamed) {
    v1::ClientMessage message;
    message.mutable_subscribe()->set_lidar("nobody");
    message.mutable_subscribe()->set_request(9);
    const auto order = order_from_message(message.SerializeAsString(), hub);
    ASSERT_FALSE(order);
    EXPECT_EQ(order.error().code, "lidar_not_found");
    EXPECT_THAT(order.error().hint, HasSubstr("A0E1C2D3"));
    EXPECT_EQ(parse(refusal_message(order.error())).error().request(), 9U);
}

TEST_F(MessagesTest, BytesThatAreNoClientMessageAreRefused) {
    for (const std::string bytes : {"", "GET / HTTP/1.1", "\xff\xff\xff\xff"}) {
        const auto order = order_from_message(bytes, hub);
        ASSERT_FALSE(order);
        EXPECT_EQ(order.error().code, "bad_message");
    }
}

TEST_F(MessagesTest, AQueryBecomesAWish) {
    const auto order =
        order_from_query({{"lidar", "ttyUSB0"}, {"kind", "sweep"}, {"compression", "none"}}, hub);
    ASSERT_TRUE(order);
    EXPECT_EQ(order->wish->lidar, 1U);
    EXPECT_EQ(order->wish->frames.format.compression, frame::Compression::none);
    EXPECT_EQ(parse(order->answer).subscribed().wish().lidar(), "A0E1C2D3");
    EXPECT_EQ(order_from_query({{"lidar", "nobody"}}, hub).error().code, "lidar_not_found");
}

}  // namespace
}  // namespace sweepcast::stream
