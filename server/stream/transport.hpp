// Transport: whole messages to and from one client, over TCP or WebSocket alike.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/frame/wire_message.hpp"

#include <boost/asio/awaitable.hpp>

#include <string>

namespace sweepcast::stream {

/// Used on one worker's thread; at most one send and one receive are under way, and they may
/// overlap.
class Transport {
public:
    virtual ~Transport() = default;

    /// Sends one message. Takes as long as the client lets it, up to the transport's own limit.
    virtual boost::asio::awaitable<Result<void>> send(const frame::WireMessage& message) = 0;

    /// The next whole message from the client.
    /// Errors: the connection's end, or a message that is too long or cut.
    virtual boost::asio::awaitable<Result<std::string>> receive() = 0;

    /// Ends the connection in good order, within a second: what was sent arrives, and a WebSocket
    /// says why. A receive() may be under way and then ends.
    virtual boost::asio::awaitable<void> close(const std::string& reason) = 0;
};

}  // namespace sweepcast::stream
