// StreamClient: one connection to a gateway's stream, over TCP or WebSocket alike.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/client/stream_url.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace sweepcast::client {

/// Longest message that is taken from a gateway.
constexpr std::size_t longest_server_message = 8 << 20;

class StreamClient {
public:
    virtual ~StreamClient() = default;

    /// Connects within `limit`.
    /// The Problem says what stands in the way and what to do.
    static boost::asio::awaitable<Result<std::unique_ptr<StreamClient>, Problem>>
    connect(StreamUrl url, std::chrono::milliseconds limit);

    /// Says what to get from now on.
    boost::asio::awaitable<Result<void>> subscribe(const v1::Subscribe& wish);

    /// Ends the frames; states go on.
    boost::asio::awaitable<Result<void>> unsubscribe();

    /// The next message; valid until the next call. Waits for as long as the gateway has nothing to
    /// say. Errors: the connection's end (boost::asio::error::eof if in good order), or bytes that
    /// are no message.
    boost::asio::awaitable<Result<const v1::ServerMessage*>> receive();

    /// Ends the connection, and with it what is under way.
    virtual void close() = 0;

    /// Bytes received so far, framing included.
    [[nodiscard]] std::uint64_t bytes_received() const { return bytes_received_; }

protected:
    /// Sends one message.
    virtual boost::asio::awaitable<Result<void>> send(std::string message) = 0;
    /// The next message's bytes; valid until the next call.
    virtual boost::asio::awaitable<Result<std::span<const std::uint8_t>>> receive_bytes() = 0;

    std::uint64_t bytes_received_{};

private:
    v1::ServerMessage message_;
};

}  // namespace sweepcast::client
