// serve_subscriber over a transport in memory.
#include "server/stream/session.hpp"

#include "driver/async/notifier.hpp"
#include "server/frame/error.hpp"
#include "server/hub/lidar_frames.hpp"
#include "sweepcast/v1/stream.pb.h"
#include "tests/server/hub/client_end.hpp"
#include "tests/server/stream/known_lidar.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

#include <deque>
#include <future>
#include <string>
#include <vector>

namespace sweepcast::stream {
namespace {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;

/// Sends to a client within the process.
class MemoryTransport final : public Transport {
public:
    explicit MemoryTransport(asio::io_context& context)
        : client(context)
        , changed(context.get_executor()) {}

    hub::Outbox& outbox() override { return client.outbox; }
    asio::awaitable<Result<std::string>> receive() override {
        if (garbled) {
            co_return make_error_code(frame::errc::length_malformed);
        }
        while (incoming.empty()) {
            if (gone) {
                co_return asio::error::make_error_code(asio::error::eof);
            }
            co_await changed.wait_until(Clock::time_point::max());
        }
        auto message = std::move(incoming.front());
        incoming.pop_front();
        co_return message;
    }
    asio::awaitable<void> close(const std::string& reason) override {
        closed_for = reason;
        gone = true;
        changed.notify();
        co_return;
    }

    hub::ClientEnd client;
    bool gone{};
    bool garbled{};
    std::deque<std::string> incoming;
    std::string closed_for;
    async::Notifier changed;
};

class SessionTest : public testing::Test {
protected:
    SessionTest() {
        add_known_lidar(hub);
        settings.client = "test";
    }
    ~SessionTest() override {
        transport.gone = true;
        transport.changed.notify();
        run();
    }

    void serve() {
        served = asio::co_spawn(
            context,
            serve_subscriber(transport, hub, settings, log),
            asio::use_future
        );
        run();
    }
    void run() { transport.client.run(); }
    /// What has come to the client since the last call.
    std::vector<v1::ServerMessage> received() {
        transport.client.read_all();
        return transport.client.take();
    }
    void say(const v1::ClientMessage& message) {
        transport.incoming.push_back(message.SerializeAsString());
        transport.changed.notify();
        run();
    }
    void publish(int sweeps) {
        for (int i = 0; i < sweeps; ++i) {
            device::CapturedSweep captured;
            captured.sweep.samples.resize(3);
            captured.lidar = "A0E1C2D3";
            captured.lidar_number = 1;
            captured.sequence = ++sequence;
            auto made = frames.of(captured);
            hub.deliver(hub::SweepNews{
                1,
                std::make_shared<const device::CapturedSweep>(std::move(captured)),
                std::move(made)});
        }
        run();
    }
    [[nodiscard]] bool ended() const {
        return served.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }

    asio::io_context context;
    hub::Variants variants;
    hub::LocalHub hub{variants};
    hub::LidarFrames frames{variants, 1};
    MemoryTransport transport{context};
    SessionSettings settings;
    std::shared_ptr<spdlog::logger> log = std::make_shared<spdlog::logger>("test");
    std::future<void> served;
    std::uint64_t sequence{};
};

TEST_F(SessionTest, GreetsFirst) {
    serve();
    const auto messages = received();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_TRUE(messages[0].has_hello());
}

TEST_F(SessionTest, AnswersASubscribeAndDeliversTheLatestAndWhatFollows) {
    serve();
    publish(2);
    EXPECT_EQ(received().size(), 1U);
    v1::ClientMessage subscribe;
    subscribe.mutable_subscribe()->set_lidar("ttyUSB0");
    subscribe.mutable_subscribe()->set_request(17);
    say(subscribe);
    publish(2);
    const auto messages = received();
    ASSERT_EQ(messages.size(), 4U);
    ASSERT_TRUE(messages[0].has_subscribed());
    EXPECT_EQ(messages[0].subscribed().wish().request(), 17U);
    EXPECT_EQ(messages[0].subscribed().wish().lidar(), "A0E1C2D3");
    EXPECT_EQ(messages[1].frame().sequence(), 2U);
    EXPECT_EQ(messages[2].frame().sequence(), 3U);
    EXPECT_EQ(messages[3].frame().sequence(), 4U);
}

TEST_F(SessionTest, AnUnsubscribeEndsTheFrames) {
    settings.order = Order{hub::Wish{}, nullptr};
    serve();
    publish(1);
    EXPECT_EQ(received().size(), 2U);
    v1::ClientMessage unsubscribe;
    unsubscribe.mutable_unsubscribe();
    say(unsubscribe);
    publish(2);
    EXPECT_EQ(received().size(), 0U);
    EXPECT_EQ(hub.subscribers(), 0U);
    EXPECT_FALSE(ended());
}

TEST_F(SessionTest, RefusesOneDistinctRequestTooManyAndItsHintIsServed) {
    std::vector<hub::VariantPtr> taken;
    for (std::uint32_t i = 0; i < hub::Variants::most; ++i) {
        hub::Wish wish;
        wish.frames.every_nth = 3 + i;
        wish.frames.format.dictionary = true;
        taken.push_back(variants.acquire(wish));
    }
    serve();
    v1::ClientMessage subscribe;
    subscribe.mutable_subscribe()->set_request(3);
    subscribe.mutable_subscribe()->set_every_nth(2);
    say(subscribe);
    const auto refused = received();
    ASSERT_EQ(refused.size(), 2U);
    EXPECT_EQ(refused[1].error().code(), "too_many_wishes");
    EXPECT_EQ(refused[1].error().request(), 3U);
    EXPECT_FALSE(ended());

    const std::string hint = refused[1].error().hint();
    const auto begin = hint.find("kind=");
    ASSERT_NE(begin, std::string::npos) << hint;
    const auto advised = subscribe_from_query(
        {{"kind",
          hint.substr(
              begin + 5,
              hint.find_first_not_of("abcdefghijklmnopqrstuvwxyz", begin + 5) - begin - 5
          )}}
    );
    ASSERT_TRUE(advised) << hint;
    *subscribe.mutable_subscribe() = *advised;
    say(subscribe);
    publish(1);
    const auto served_now = received();
    ASSERT_EQ(served_now.size(), 2U);
    EXPECT_TRUE(served_now[0].has_subscribed());
    EXPECT_TRUE(served_now[1].has_frame());
}

TEST_F(SessionTest, DeliversAtOnceWhenTheWishCameWithTheConnection) {
    settings.order = Order{hub::Wish{}, nullptr};
    serve();
    publish(1);
    const auto messages = received();
    ASSERT_EQ(messages.size(), 2U);
    EXPECT_TRUE(messages[1].has_frame());
}

TEST_F(SessionTest, PushesStateChangesWithoutBeingAsked) {
    serve();
    add_known_lidar(hub);
    const auto messages = received();
    ASSERT_EQ(messages.size(), 2U);
    EXPECT_TRUE(messages[1].has_lidar());
}

TEST_F(SessionTest, RefusesAnImpossibleWishAndGoesOn) {
    serve();
    v1::ClientMessage subscribe;
    subscribe.mutable_subscribe()->set_lidar("nobody");
    say(subscribe);
    const auto messages = received();
    ASSERT_EQ(messages.size(), 2U);
    EXPECT_EQ(messages[1].error().code(), "lidar_not_found");
    EXPECT_FALSE(ended());
}

TEST_F(SessionTest, TellsAClientThatDidNotReadWhatItMissed) {
    settings.order = Order{hub::Wish{}, nullptr};
    settings.mailbox.frames = 2;
    serve();
    publish(1000);  // more than the kernel takes
    std::uint64_t last = 0;
    std::uint64_t missed = 0;
    std::uint64_t told = 0;
    for (const auto& message : received()) {
        if (message.has_frame()) {
            missed += message.frame().sequence() - last - 1;
            last = message.frame().sequence();
        } else if (message.has_stats()) {
            told = message.stats().frames_dropped();
        }
    }
    EXPECT_EQ(last, 1000U);
    EXPECT_GT(missed, 0U);
    EXPECT_EQ(told, missed);
}

TEST_F(SessionTest, EndsWhenTheClientGoes) {
    settings.order = Order{hub::Wish{}, nullptr};
    serve();
    EXPECT_EQ(hub.subscribers(), 1U);
    transport.gone = true;
    transport.changed.notify();
    run();
    EXPECT_TRUE(ended());
    EXPECT_EQ(hub.subscribers(), 0U);
}

TEST_F(SessionTest, SaysWhyItEndsAConnectionThatDoesNotSpeakTheProtocol) {
    transport.garbled = true;
    serve();
    ASSERT_TRUE(ended());
    const auto messages = received();
    EXPECT_TRUE(messages.back().has_closing());
    EXPECT_EQ(transport.closed_for, messages.back().closing().reason());
}

TEST_F(SessionTest, EndsWithAFarewellWhenTheGatewayDoes) {
    serve();
    hub.close_all(closing_message("going down"), "going down");
    run();
    ASSERT_TRUE(ended());
    EXPECT_EQ(received().back().closing().reason(), "going down");
    EXPECT_EQ(transport.closed_for, "going down");
}

}  // namespace
}  // namespace sweepcast::stream
