// Outbox: straight to the socket, or through the mailbox when the socket takes no more.
#include "server/hub/outbox.hpp"

#include "tests/server/hub/client_end.hpp"

#include <boost/asio/error.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace sweepcast::hub {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using testing::ElementsAre;

constexpr std::size_t usual_size = 3000;
constexpr std::size_t beyond_any_buffer = 1U << 20U;

frame::WireMessagePtr frame_of(std::uint64_t sequence, std::size_t size = usual_size) {
    v1::ServerMessage message;
    message.mutable_frame()->set_sequence(sequence);
    message.mutable_frame()->set_body(std::string(size, 'x'));
    return std::make_shared<const frame::WireMessage>(message);
}

frame::WireMessagePtr control(const std::string& id) {
    v1::ServerMessage message;
    message.mutable_lidar()->set_id(id);
    return std::make_shared<const frame::WireMessage>(message);
}

frame::WireMessagePtr missed(const OutboxCounts& counts) {
    v1::ServerMessage message;
    message.mutable_stats()->set_frames_sent(counts.frames_sent);
    message.mutable_stats()->set_frames_dropped(counts.frames_dropped);
    return std::make_shared<const frame::WireMessage>(message);
}

/// Each message in a word: "frame 1", "dropped 3", or a control message's id.
std::vector<std::string> words(const std::vector<v1::ServerMessage>& messages) {
    std::vector<std::string> words;
    for (const auto& message : messages) {
        if (message.has_frame()) {
            words.push_back("frame " + std::to_string(message.frame().sequence()));
        } else if (message.has_stats()) {
            words.push_back("dropped " + std::to_string(message.stats().frames_dropped()));
        } else {
            words.push_back(message.lidar().id());
        }
    }
    return words;
}

class OutboxTest : public testing::Test {
protected:
    /// Has the client not read, and the socket take no more than a part of frame 1.
    void stall(MailboxLimits limits = {}, std::chrono::milliseconds between_news = 1h) {
        client.start(limits, missed, between_news);
        client.outbox.push_frame(frame_of(1, beyond_any_buffer));
        client.run();
        ASSERT_GT(client.read(1), 0U) << "nothing of it has gone out";
    }
    void read_on() { client.read_all(); }

    asio::io_context context;
    ClientEnd client{context};
    Outbox& outbox = client.outbox;
};

TEST_F(OutboxTest, SendsFromWithinThePushWhileTheSocketTakesIt) {
    outbox.push_control(control("state"));
    outbox.push_frame(frame_of(1, 100));
    client.read(2 * usual_size);  // nothing has run
    EXPECT_THAT(words(client.take()), ElementsAre("state", "frame 1"));
    EXPECT_EQ(outbox.counts().frames_sent, 1U);
}

TEST_F(OutboxTest, OverWebSocketSendsTheSameMessageAsABinaryFrame) {
    ClientEnd websocket(context, frame::Framing::websocket);
    const auto frame = frame_of(1);
    websocket.outbox.push_frame(frame);
    websocket.read_all();
    const auto expected = frame->framed(frame::Framing::websocket).head;
    EXPECT_TRUE(std::ranges::equal(websocket.raw(), expected));
}

TEST_F(OutboxTest, FinishesAFrameThatTheSocketTookAPartOf) {
    stall();
    outbox.push_frame(frame_of(2));
    outbox.push_control(control("state"));
    read_on();
    EXPECT_THAT(words(client.take()), ElementsAre("frame 1", "state", "frame 2"));
    outbox.push_frame(frame_of(3));
    client.read(2 * usual_size);  // straight again
    EXPECT_THAT(words(client.take()), ElementsAre("frame 3"));
}

TEST_F(OutboxTest, DropsTheOldestThatWaitAndTellsHowMany) {
    stall({.frames = 2}, 0ms);
    for (std::uint64_t sequence = 2; sequence <= 9; ++sequence) {
        outbox.push_frame(frame_of(sequence));
    }
    EXPECT_LE(outbox.waiting_bytes(), 2 * frame_of(9)->size());
    read_on();
    EXPECT_THAT(words(client.take()), ElementsAre("frame 1", "dropped 6", "frame 8", "frame 9"));
    EXPECT_EQ(outbox.counts().frames_sent, 3U);
    EXPECT_EQ(outbox.counts().frames_dropped, 6U);
}

TEST_F(OutboxTest, ReportsTheFirstLossAtOnceHoweverShortTheMachineHasBeenUp) {
    stall({.frames = 2}, std::chrono::years(100));
    for (std::uint64_t sequence = 2; sequence <= 9; ++sequence) {
        outbox.push_frame(frame_of(sequence));
    }
    read_on();
    EXPECT_THAT(words(client.take()), ElementsAre("frame 1", "dropped 6", "frame 8", "frame 9"));
}

TEST_F(OutboxTest, TellsNoMoreOftenThanAgreed) {
    stall({.frames = 1}, 1h);
    for (std::uint64_t sequence = 2; sequence <= 50; ++sequence) {
        outbox.push_frame(frame_of(sequence, beyond_any_buffer));
        if (sequence % 5 == 0) {
            read_on();  // all that waits goes out, and something was dropped before
        }
    }
    EXPECT_GE(outbox.counts().frames_dropped, 10U);
    const auto said = words(client.take());
    EXPECT_LE(
        std::ranges::count_if(said, [](auto& word) { return word.starts_with("dropped"); }),
        1
    );
}

TEST_F(OutboxTest, TellsTheFinalCountOnceAStallHasEnded) {
    stall({.frames = 1}, 20ms);
    outbox.push_frame(frame_of(2));
    outbox.push_frame(frame_of(3, beyond_any_buffer));  // drops 2
    while (client.take().empty()) {                     // reads frame 1: told of one
        client.run();
        client.read(usual_size);
    }
    outbox.push_frame(frame_of(4));
    outbox.push_frame(frame_of(5));
    read_on();
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    std::uint64_t told = 0;
    while (told != outbox.counts().frames_dropped && std::chrono::steady_clock::now() < deadline) {
        context.restart();
        context.run_one_for(10ms);
        client.read_all();
        for (const auto& message : client.take()) {
            told = message.has_stats() ? message.stats().frames_dropped() : told;
        }
    }
    EXPECT_GE(told, 2U);
    EXPECT_EQ(told, outbox.counts().frames_dropped);
}

TEST_F(OutboxTest, BytesOfTheTransportsOwnWaitForTheFrameUnderWayAndNoLonger) {
    stall();
    outbox.push_control(control("state"));
    outbox.push_frame(frame_of(2));
    // A message that is no frame and no control message here: what matters is where it lands.
    const auto pong = control("pong");
    std::vector<std::uint8_t> bytes;
    frame::append_delimited(bytes, pong->message());
    std::optional<boost::system::error_code> sent;
    outbox.write(bytes, Outbox::Last::no, [&](auto failed) { sent = failed; });
    client.run();
    EXPECT_FALSE(sent);
    read_on();
    EXPECT_THAT(words(client.take()), ElementsAre("frame 1", "pong", "state", "frame 2"));
    ASSERT_TRUE(sent);
    EXPECT_FALSE(*sent);
}

TEST_F(OutboxTest, NothingFollowsTheLastBytesOfTheTransport) {
    stall();
    outbox.push_frame(frame_of(2));
    std::vector<std::uint8_t> bytes;
    frame::append_delimited(bytes, control("close")->message());
    outbox.write(bytes, Outbox::Last::yes, [](auto) {});
    read_on();
    outbox.push_frame(frame_of(3));
    outbox.push_control(control("late"));
    read_on();
    EXPECT_THAT(words(client.take()), ElementsAre("frame 1", "close"));
    EXPECT_FALSE(outbox.is_finished()) << "the transport ends the connection";
}

TEST_F(OutboxTest, OnceClosedEndsWhenTheControlMessagesAreOut) {
    stall();
    outbox.push_frame(frame_of(2));
    outbox.push_control(control("farewell"));
    outbox.close("first reason");
    outbox.close("second reason");
    outbox.push_frame(frame_of(3));
    outbox.push_control(control("late"));
    client.run();
    EXPECT_FALSE(client.ended());
    read_on();
    EXPECT_THAT(words(client.take()), ElementsAre("frame 1", "farewell"));
    EXPECT_TRUE(client.ended());
    EXPECT_TRUE(outbox.is_finished());
    EXPECT_EQ(outbox.end_reason(), "first reason");
}

TEST_F(OutboxTest, ClosingWithNothingWaitingIsFinishedAndCallsWhoEndsTheConnection) {
    int calls = 0;
    outbox.set_up({}, missed, [&] { ++calls; });
    outbox.close("over");
    EXPECT_EQ(calls, 1);
    EXPECT_TRUE(outbox.is_finished());
}

TEST_F(OutboxTest, NeedsNobodyWhileTheClientReads) {
    outbox.set_up({}, missed, [] { FAIL() << "there is nothing to do"; });
    for (std::uint64_t sequence = 1; sequence <= 100; ++sequence) {
        outbox.push_frame(frame_of(sequence, 100));
        outbox.push_control(control("state"));
        client.read_all();
    }
    EXPECT_EQ(client.take().size(), 200U);
}

TEST_F(OutboxTest, ClosesWhenTooManyControlMessagesWait) {
    stall({.controls = 2});
    for (const auto* name : {"1", "2", "3", "4"}) {
        outbox.push_control(control(name));
    }
    EXPECT_THAT(outbox.end_reason(), testing::HasSubstr("too many state messages"));
    read_on();
    EXPECT_THAT(words(client.take()), ElementsAre("frame 1", "1", "2"));
    EXPECT_TRUE(client.ended());
}

TEST_F(OutboxTest, EndsWhenTheClientLeavesWhileItIsStalled) {
    stall();
    client.hang_up();
    client.run();
    EXPECT_TRUE(client.ended());
    EXPECT_TRUE(outbox.failed());
    EXPECT_NE(outbox.end_reason(), "");
}

TEST_F(OutboxTest, EndsWhenAFrameFindsTheClientGone) {
    client.start({}, missed, 1h);
    client.hang_up();
    outbox.push_frame(frame_of(1));
    outbox.push_frame(frame_of(2));
    client.run();
    EXPECT_TRUE(client.ended());
    EXPECT_TRUE(outbox.failed());
}

TEST_F(OutboxTest, AWriteThatCannotEndAnyMoreIsToldSo) {
    stall();
    const std::vector<std::uint8_t> bytes(10);
    std::optional<boost::system::error_code> sent;
    outbox.write(bytes, Outbox::Last::no, [&](auto failed) { sent = failed; });
    outbox.abort(asio::error::timed_out);
    ASSERT_TRUE(sent);
    EXPECT_EQ(*sent, asio::error::timed_out);
    client.run();
    EXPECT_TRUE(client.ended());
}

/// Everything at once, many times: what arrives is whole, in order, and the count is right.
TEST_F(OutboxTest, WhateverAClientDoesItIsToldExactlyWhatItMissed) {
    std::mt19937 random(5);  // NOLINT(cert-msc51-cpp): the same in every run
    const auto one_in = [&random](unsigned many) { return random() % many == 0; };
    client.start({.frames = 3}, missed, 0ms);
    std::uint64_t pushed = 0;
    std::uint64_t controls = 0;
    for (int step = 0; step < 5000; ++step) {
        outbox.push_frame(frame_of(++pushed, random() % (one_in(20) ? 300'000 : 5'000)));
        if (one_in(7)) {
            outbox.push_control(control(std::to_string(++controls)));
        }
        if (one_in(3)) {
            client.run();
            client.read(random() % 20'000);
        }
    }
    read_on();
    std::uint64_t gaps = 0;
    std::uint64_t last = 0;
    std::uint64_t last_control = 0;
    std::uint64_t told = 0;
    for (const auto& message : client.take()) {
        if (message.has_frame()) {
            ASSERT_GT(message.frame().sequence(), last);
            gaps += message.frame().sequence() - last - 1;
            last = message.frame().sequence();
        } else if (message.has_stats()) {
            told = message.stats().frames_dropped();
        } else {
            EXPECT_EQ(message.lidar().id(), std::to_string(++last_control));
        }
    }
    EXPECT_EQ(last, pushed);
    EXPECT_EQ(last_control, controls);
    EXPECT_GT(gaps, 0U);
    EXPECT_EQ(told, gaps);
}

}  // namespace
}  // namespace sweepcast::hub
