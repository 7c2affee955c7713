// The client against a gateway that the test plays: what comes, and what happens when it goes.
#include "server/client/client.hpp"

#include "server/client/blocking_client.hpp"
#include "server/client/known_lidars.hpp"
#include "server/frame/error.hpp"
#include "server/frame/frame_encoder.hpp"
#include "server/frame/message_framing.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/asio/write.hpp>
#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <utility>
#include <vector>

using namespace std::chrono_literals;
using boost::asio::ip::tcp;

namespace sweepcast::client {
namespace {

constexpr auto patience = 60'000ms;

/// The gateway's end of a connection.
class Peer {
public:
    explicit Peer(tcp::socket socket) : socket_(std::move(socket)) {}

    void say(const v1::ServerMessage& message) { say(frame::WireMessage(message)); }

    void say(const frame::WireMessage& message) {
        const auto bytes = message.framed(frame::Framing::delimited);
        for (const auto part : {bytes.head, bytes.tail}) {
            boost::asio::write(socket_, boost::asio::buffer(part.data(), part.size()));
        }
    }

    void greet(std::uint32_t version = 1) {
        v1::ServerMessage message;
        message.mutable_hello()->set_protocol_version(version);
        say(message);
    }

    void say_raw(const std::string& bytes) {
        boost::asio::write(socket_, boost::asio::buffer(bytes));
    }

    /// What the client says next; its messages are short here.
    v1::ClientMessage hear() {
        std::uint8_t length{};
        boost::asio::read(socket_, boost::asio::buffer(&length, 1));
        std::string bytes(length, '\0');
        boost::asio::read(socket_, boost::asio::buffer(bytes));
        v1::ClientMessage message;
        EXPECT_TRUE(message.ParseFromString(bytes));
        return message;
    }

private:
    tcp::socket socket_;
};

class ClientTest : public testing::Test {
protected:
    [[nodiscard]] StreamUrl url() const {
        return {false, "127.0.0.1", std::to_string(acceptor_.local_endpoint().port()), ""};
    }

    Peer accept() { return Peer(acceptor_.accept()); }

    boost::asio::io_context context_;
    tcp::acceptor acceptor_{context_, {boost::asio::ip::make_address("127.0.0.1"), 0}};
};

/// The next event, which must be of this kind and come in time.
template <class Kind>
Kind expect_next(BlockingClient& client) {
    auto event = client.next(patience);
    if (!event) {
        throw std::runtime_error(event.error().cause);
    }
    return std::get<Kind>(event->value());
}

ClientOptions impatient(Reconnect reconnect = Reconnect::always) {
    ClientOptions options;
    options.reconnect = reconnect;
    options.backoff = {1ms, 10ms};
    return options;
}

frame::WireMessagePtr sweep_message(std::uint64_t sequence, const std::string& lidar = "A") {
    static const std::vector<protocol::Sample> samples{{{}, {4000}, {100}, 188, 1}};
    frame::FrameContent content;
    content.lidar = lidar;
    content.sequence = sequence;
    content.samples = samples;
    return frame::FrameEncoder().encode(content, {});
}

TEST_F(ClientTest, TellsOfGreetingStatesAndScans) {
    auto options = impatient();
    options.wish->set_lidar("A");
    options.wish->set_every_nth(2);
    BlockingClient client(url(), options);
    std::thread gateway([this] {
        auto peer = accept();
        peer.greet();
        const auto wish = peer.hear().subscribe();
        EXPECT_EQ(wish.lidar(), "A");
        EXPECT_EQ(wish.every_nth(), 2U);
        EXPECT_EQ(wish.dictionaries_size(), 1) << "it has ours, and says so";
        v1::ServerMessage state;
        state.mutable_lidar()->set_id("A");
        peer.say(state);
        peer.say(*sweep_message(5));
        peer.say(*sweep_message(8));
        peer.hear();  // holds until the client has seen it all
    });
    EXPECT_EQ(expect_next<Connected>(client).hello.protocol_version(), 1U);
    EXPECT_EQ(expect_next<v1::Lidar>(client).id(), "A");
    const auto first = expect_next<Scan>(client);
    EXPECT_EQ(first.lidar, "A");
    EXPECT_EQ(first.sequence, 5U);
    EXPECT_EQ(first.missed, 0U);
    EXPECT_EQ(first.scan.sweep.samples.at(0).distance.raw, 4000U);
    EXPECT_GT(first.wire_bytes, 10U);
    EXPECT_EQ(expect_next<Scan>(client).missed, 2U);
    client.set_wish(std::nullopt);
    gateway.join();
}

v1::ServerMessage subscribed() {
    v1::ServerMessage message;
    message.mutable_subscribed();
    return message;
}

TEST_F(ClientTest, CountsMissedFramesOfAWishFromItsAnswerOn) {
    BlockingClient client(url(), impatient());
    std::thread gateway([this] {
        auto peer = accept();
        peer.greet();
        peer.hear();
        peer.say(subscribed());
        peer.say(*sweep_message(5));
        peer.hear();  // the next wish, which is answered after two frames of the one before
        peer.say(*sweep_message(6));
        peer.say(*sweep_message(8));
        peer.say(subscribed());
        peer.say(*sweep_message(12));
        peer.say(*sweep_message(14));
        peer.hear();
    });
    expect_next<Connected>(client);
    expect_next<v1::Subscribed>(client);
    EXPECT_EQ(expect_next<Scan>(client).missed, 0U);
    client.set_wish(v1::Subscribe{});
    EXPECT_EQ(expect_next<Scan>(client).missed, 0U) << "sweep 6";
    EXPECT_EQ(expect_next<Scan>(client).missed, 1U) << "sweep 8";
    expect_next<v1::Subscribed>(client);
    EXPECT_EQ(expect_next<Scan>(client).missed, 0U) << "the first of the new wish";
    EXPECT_EQ(expect_next<Scan>(client).missed, 1U);
    client.set_wish(std::nullopt);
    gateway.join();
}

TEST_F(ClientTest, GoesOnCountingMissedFramesIfAWishIsRefused) {
    BlockingClient client(url(), impatient());
    std::thread gateway([this] {
        auto peer = accept();
        peer.greet();
        peer.hear();
        peer.say(subscribed());
        peer.say(*sweep_message(5));
        peer.hear();
        v1::ServerMessage refusal;
        refusal.mutable_error()->set_code("bad_value");
        peer.say(refusal);
        peer.say(*sweep_message(8));
        peer.hear();
    });
    expect_next<Connected>(client);
    expect_next<v1::Subscribed>(client);
    expect_next<Scan>(client);
    client.set_wish(v1::Subscribe{});
    expect_next<v1::StreamError>(client);
    EXPECT_EQ(expect_next<Scan>(client).missed, 2U);
    client.set_wish(std::nullopt);
    gateway.join();
}

TEST_F(ClientTest, ConnectsAgainAndRepeatsItsWish) {
    auto options = impatient();
    options.wish->set_every_nth(3);
    BlockingClient client(url(), options);
    std::thread gateway([this] {
        for (int i = 0; i < 2; ++i) {
            auto peer = accept();
            peer.greet();
            EXPECT_EQ(peer.hear().subscribe().every_nth(), 3U);
            v1::ServerMessage farewell;
            farewell.mutable_closing()->set_reason("the gateway is shutting down");
            peer.say(farewell);
        }
    });
    for (int i = 0; i < 2; ++i) {
        expect_next<Connected>(client);
        const auto lost = expect_next<Disconnected>(client);
        EXPECT_EQ(lost.why.cause, "the gateway ends the connection: the gateway is shutting down");
        EXPECT_GE(lost.retry_in, 1ms);
        EXPECT_LE(lost.retry_in, 10ms);
    }
    gateway.join();
}

TEST_F(ClientTest, DoesNotTryAgainIfItIsNotToOrWasNeverConnected) {
    const auto nowhere = url();
    acceptor_.close();
    for (const auto reconnect : {Reconnect::never, Reconnect::once_connected}) {
        BlockingClient client(nowhere, impatient(reconnect));
        const auto event = client.next();
        ASSERT_FALSE(event);
        EXPECT_NE(event.error().cause.find("cannot connect to 127.0.0.1"), std::string::npos);
        EXPECT_FALSE(event.error().hint.empty());
    }
    BlockingClient stubborn(nowhere, impatient());
    for (int i = 0; i < 3; ++i) {
        EXPECT_FALSE(expect_next<Disconnected>(stubborn).why.cause.empty());
    }
}

TEST_F(ClientTest, SaysIfWhatAnswersIsNoGatewayOrAnotherVersion) {
    std::thread server([this] {
        accept().say_raw(
            "SSH-2.0-OpenSSH_9.2p1 Debian-2+deb12u3 and so on, on and on and on and on and on\r\n"
        );
        accept().greet(2);
    });
    BlockingClient ssh(url(), impatient(Reconnect::never));
    const auto no_gateway = ssh.next();
    ASSERT_FALSE(no_gateway);
    EXPECT_NE(no_gateway.error().cause.find("does not greet"), std::string::npos);
    BlockingClient newer(url(), impatient(Reconnect::never));
    const auto version = newer.next();
    ASSERT_FALSE(version);
    EXPECT_NE(version.error().cause.find("version 2"), std::string::npos);
    server.join();
}

TEST_F(ClientTest, GivesUpAMessageThatIsTooLongBeforeItComes) {
    BlockingClient client(url(), impatient(Reconnect::never));
    std::thread gateway([this] {
        auto peer = accept();
        peer.greet();
        peer.hear();
        peer.say_raw("\x81\x80\x80\x04");  // the length, one byte more than 8 MiB
        EXPECT_ANY_THROW(peer.hear()) << "the connection is to end";
    });
    expect_next<Connected>(client);
    const auto event = client.next(patience);
    EXPECT_FALSE(event) << "the client waits for the message";
    EXPECT_EQ(event ? error_code() : event.error().code, frame::errc::message_too_long);
    client.cancel();
    gateway.join();
}

TEST_F(ClientTest, GivesUpOnOneThatNeverGreets) {
    auto options = impatient(Reconnect::never);
    options.connect_limit = 50ms;
    BlockingClient client(url(), options);
    const auto event = client.next();
    ASSERT_FALSE(event);
    EXPECT_EQ(event.error().code, boost::asio::error::timed_out);
}

TEST_F(ClientTest, RepeatsARefusedWishWhenTheLidarAppears) {
    auto options = impatient();
    options.wish->set_lidar("A0E1C2D3");
    BlockingClient client(url(), options);
    std::thread gateway([this] {
        auto peer = accept();
        peer.greet();
        peer.hear();
        v1::ServerMessage refusal;
        refusal.mutable_error()->set_code("lidar_not_found");
        peer.say(refusal);
        for (const auto* id : {"ttyUSB0", "A0E1C2D3"}) {
            v1::ServerMessage state;
            state.mutable_lidar()->set_id(id);
            peer.say(state);
        }
        EXPECT_EQ(peer.hear().subscribe().lidar(), "A0E1C2D3");
        peer.say(*sweep_message(1));
    });
    expect_next<Connected>(client);
    EXPECT_EQ(expect_next<v1::StreamError>(client).code(), "lidar_not_found");
    expect_next<v1::Lidar>(client);
    expect_next<v1::Lidar>(client);
    expect_next<Scan>(client);
    gateway.join();
}

TEST_F(ClientTest, WaitsLongestAfterItWasGivenUp) {
    auto options = impatient();
    options.backoff = {1ms, 10'000ms};
    Client client(context_.get_executor(), url(), options);
    auto next = [&] {
        auto event = boost::asio::co_spawn(context_, client.next(), boost::asio::use_future);
        context_.restart();
        context_.run();
        return event.get();
    };
    std::thread gateway([this] {
        auto peer = accept();
        peer.greet();
        peer.hear();
        EXPECT_ANY_THROW(peer.hear()) << "the connection is to end";
    });
    const auto first = next();
    ASSERT_TRUE(first && std::holds_alternative<Connected>(*first));
    client.give_up({{}, "nonsense came", ""});
    const auto event = next();
    ASSERT_TRUE(event && std::holds_alternative<Disconnected>(*event));
    const auto& lost = std::get<Disconnected>(*event);
    EXPECT_EQ(lost.why.cause, "nonsense came");
    EXPECT_GE(lost.retry_in, 5000ms);
    gateway.join();
}

v1::ServerMessage state_of(std::uint32_t number, const std::string& id) {
    v1::ServerMessage message;
    message.mutable_lidar()->set_number(number);
    message.mutable_lidar()->set_id(id);
    return message;
}

TEST_F(ClientTest, LeavesOutTheLidarsBeyondItsBoundAndSaysSoOnce) {
    constexpr std::uint32_t too_many = 3;
    Client client(context_.get_executor(), url(), impatient());
    auto next = [&] {
        auto event = boost::asio::co_spawn(context_, client.next(), boost::asio::use_future);
        context_.restart();
        context_.run();
        return *event.get();
    };
    std::thread gateway([this] {
        auto peer = accept();
        v1::ServerMessage greeting;
        greeting.mutable_hello()->set_protocol_version(1);
        for (std::uint32_t i = 0; i < most_lidars + too_many; ++i) {
            greeting.mutable_hello()->add_lidars()->set_number(i);
        }
        peer.say(greeting);
        peer.hear();
        peer.say(state_of(most_lidars, "one more"));
        peer.say(state_of(0, std::string(longest_lidar_name + 1, 'A')));
        peer.say(state_of(0, "known"));
        EXPECT_ANY_THROW(peer.hear()) << "the connection is to end";
    });
    EXPECT_EQ(
        static_cast<std::size_t>(std::get<Connected>(next()).hello.lidars_size()),
        most_lidars
    );
    EXPECT_TRUE(std::holds_alternative<LeftOut>(next()));
    EXPECT_EQ(std::get<v1::Lidar>(next()).id(), "known");
    EXPECT_EQ(client.left_out(), too_many + 2U);
    client.cancel();
    gateway.join();
}

TEST_F(ClientTest, LeavesOutTheStatesThatTakeTooMuchMemory) {
    BlockingClient client(url(), impatient());
    std::thread gateway([this] {
        auto peer = accept();
        v1::ServerMessage greeting;
        greeting.mutable_hello()->set_protocol_version(1);
        for (const auto size : {most_lidar_memory / 2, most_lidar_memory + 1}) {
            greeting.mutable_hello()->add_lidars()->set_hint(std::string(size, 'A'));
        }
        peer.say(greeting);
        auto wordy = state_of(0, "wordy");
        wordy.mutable_lidar()->set_hint(std::string(most_lidar_memory + 1, 'A'));
        peer.say(wordy);
        auto many_parts = state_of(0, "many parts");
        while (many_parts.lidar().modes_size() < 10'000) {
            many_parts.mutable_lidar()->add_modes();  // two bytes each on the wire
        }
        EXPECT_LT(many_parts.ByteSizeLong(), most_lidar_memory);
        peer.say(many_parts);
        peer.say(state_of(0, "small"));
        peer.hear();  // holds until the client has seen it all
    });
    EXPECT_EQ(expect_next<Connected>(client).hello.lidars_size(), 1);
    expect_next<LeftOut>(client);
    EXPECT_EQ(expect_next<v1::Lidar>(client).id(), "small");
    client.set_wish(std::nullopt);
    gateway.join();
}

TEST_F(ClientTest, ShortensTheWordsOfARefusalAtTheEndOfACharacter) {
    BlockingClient client(url(), impatient());
    std::thread gateway([this] {
        auto peer = accept();
        peer.greet();
        peer.hear();
        v1::ServerMessage refusal;
        refusal.mutable_error()->set_message(std::string(longest_text - 1, 'A') + "\u00b0C");
        refusal.mutable_error()->set_hint(std::string(longest_text, 'A'));
        peer.say(refusal);
        peer.hear();  // holds until the client has seen it
    });
    expect_next<Connected>(client);
    const auto refusal = expect_next<v1::StreamError>(client);
    EXPECT_EQ(refusal.message(), std::string(longest_text - 1, 'A'));
    EXPECT_EQ(refusal.hint().size(), longest_text);
    client.set_wish(std::nullopt);
    gateway.join();
}

TEST_F(ClientTest, LeavesOutTheFramesOfLidarsBeyondItsBound) {
    BlockingClient client(url(), impatient());
    std::thread gateway([this] {
        auto peer = accept();
        peer.greet();
        peer.hear();
        for (std::size_t i = 0; i <= most_lidars; ++i) {
            peer.say(*sweep_message(1, std::to_string(i)));
        }
        peer.say(*sweep_message(2, "0"));
        peer.hear();  // holds until the client has seen it all
    });
    expect_next<Connected>(client);
    for (std::size_t i = 0; i < most_lidars; ++i) {
        EXPECT_EQ(expect_next<Scan>(client).lidar, std::to_string(i));
    }
    expect_next<LeftOut>(client);
    EXPECT_EQ(expect_next<Scan>(client).lidar, "0");
    client.set_wish(std::nullopt);
    gateway.join();
}

TEST_F(ClientTest, ALimitedWaitLosesNothing) {
    BlockingClient client(url(), impatient());
    std::thread gateway([this] {
        auto peer = accept();
        peer.greet();
        peer.hear();  // the first wish
        peer.hear();  // the second: sent after waits in vain
        peer.say(*sweep_message(1));
    });
    expect_next<Connected>(client);
    for (int i = 0; i < 3; ++i) {
        const auto nothing = client.next(1ms);
        ASSERT_TRUE(nothing);
        EXPECT_FALSE(*nothing);
    }
    client.set_wish(v1::Subscribe{});
    EXPECT_EQ(expect_next<Scan>(client).sequence, 1U);
    gateway.join();
}

TEST_F(ClientTest, CancelEndsAWaitInAnotherThread) {
    BlockingClient client(url(), impatient());
    std::thread gateway([this, &client] {
        auto peer = accept();
        peer.greet();
        peer.hear();
        client.cancel();
        EXPECT_ANY_THROW(peer.hear()) << "the connection is to end";
    });
    expect_next<Connected>(client);
    for (int i = 0; i < 2; ++i) {
        const auto event = client.next();
        ASSERT_FALSE(event);
        EXPECT_EQ(event.error().code, boost::asio::error::operation_aborted);
    }
    gateway.join();
}

}  // namespace
}  // namespace sweepcast::client
