// Transport: whole messages to and from one client, over TCP or WebSocket alike.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/hub/outbox.hpp"

#include <boost/asio/awaitable.hpp>

#include <string>

namespace sweepcast::stream {

/// Used on one worker's thread; at most one receive is under way.
class Transport {
public:
    virtual ~Transport() = default;

    /// The way out to the client, framed as the transport does it. Somebody must run() it.
    [[nodiscard]] virtual hub::Outbox& outbox() = 0;

    /// The next whole message from the client.
    /// Errors: the connection's end, or a message that is too long or cut.
    virtual boost::asio::awaitable<Result<std::string>> receive() = 0;

    /// Ends the connection in good order, within a second: what was sent arrives, and a WebSocket
    /// says why. A receive() may be under way and then ends.
    virtual boost::asio::awaitable<void> close(const std::string& reason) = 0;
};

}  // namespace sweepcast::stream
