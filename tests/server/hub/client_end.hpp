// A client's end of an outbox: a pair of sockets within the process.
#pragma once

#include "server/frame/message_framing.hpp"
#include "server/frame/wire_message.hpp"
#include "server/hub/outbox.hpp"
#include "sweepcast/v1/stream.pb.h"
#include "tests/server/hub/socket_pair.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <future>
#include <utility>
#include <vector>

namespace sweepcast::hub {

/// Reads what an outbox sends. Everything happens in run(), without waiting.
class ClientEnd {
public:
    using Socket = boost::asio::ip::tcp::socket;

    explicit ClientEnd(boost::asio::io_context& context)
        : ClientEnd(context, frame::Framing::delimited) {}
    ClientEnd(boost::asio::io_context& context, frame::Framing framing)
        : ClientEnd(context, framing, socket_pair(context.get_executor())) {}
    ~ClientEnd() {
        hang_up();
        run();
    }
    ClientEnd(const ClientEnd&) = delete;
    ClientEnd& operator=(const ClientEnd&) = delete;

    /// Sets the outbox up, and runs it when it asks for that.
    void
    start(MailboxLimits limits, Outbox::TellMissed missed, std::chrono::milliseconds between_news) {
        const auto attend = [this] {
            EXPECT_TRUE(ended()) << "asks twice";
            ended_ = boost::asio::co_spawn(context_, outbox.run(), boost::asio::use_future);
        };
        outbox.set_up(limits, missed, attend, between_news);
    }
    /// Lets everything happen that can without more being read.
    void run() {
        context_.restart();
        context_.poll();
    }
    /// Whether the outbox has nothing to do.
    [[nodiscard]] bool ended() const {
        return !ended_.valid() ||
               ended_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }

    /// Reads at most so many bytes, if they are there.
    std::size_t read(std::size_t most) {
        std::vector<std::uint8_t> chunk(most);
        boost::system::error_code ended;
        const auto got = client_.read_some(boost::asio::buffer(chunk), ended);
        chunk.resize(got);
        raw_.insert(raw_.end(), chunk.begin(), chunk.end());
        reader_.push(chunk);
        for (auto message = reader_.next(); message && *message; message = reader_.next()) {
            EXPECT_TRUE(messages_.emplace_back().ParseFromArray(
                (*message)->data(),
                static_cast<int>((*message)->size())
            ));
        }
        return got;
    }
    /// Reads until nothing more comes.
    void read_all() {
        constexpr std::size_t chunk = 65536;
        do {
            run();
        } while (read(chunk) > 0);
    }
    /// Leaves.
    void hang_up() {
        boost::system::error_code ignored;
        client_.close(ignored);
    }

    /// The bytes that came.
    [[nodiscard]] const std::vector<std::uint8_t>& raw() const { return raw_; }
    /// The messages that came since this was last called; none over WebSocket.
    std::vector<v1::ServerMessage> take() { return std::exchange(messages_, {}); }

private:
    ClientEnd(
        boost::asio::io_context& context,
        frame::Framing framing,
        std::pair<Socket, Socket> sockets
    )
        : context_(context)
        , client_(std::move(sockets.first))
        , outbox(std::move(sockets.second), framing) {}

    boost::asio::io_context& context_;
    Socket client_;

public:
    Outbox outbox;

private:
    std::future<void> ended_;
    std::vector<std::uint8_t> raw_;
    frame::DelimitedReader reader_{1U << 24U};
    std::vector<v1::ServerMessage> messages_;
};

}  // namespace sweepcast::hub
