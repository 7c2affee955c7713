// Client: a subscriber of a gateway's stream, for programs that use Asio. Reconnects by itself.
// (BlockingClient is for those that do not.)
#pragma once

#include "driver/async/backoff.hpp"
#include "driver/protocol/result.hpp"
#include "server/client/event.hpp"
#include "server/client/stream_url.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

namespace sweepcast::client {

/// When to connect again by itself.
enum class Reconnect : std::uint8_t {
    never,
    once_connected,  ///< the first attempt must succeed: a mistyped address shows at once
    always,
};

struct ClientOptions {
    /// What to get; an empty one: every sweep of every lidar. None: what the URL's query says, or
    /// states only.
    std::optional<v1::Subscribe> wish{v1::Subscribe{}};
    Reconnect reconnect{Reconnect::always};
    async::Backoff backoff{};
    /// For a connection and the gateway's greeting.
    std::chrono::milliseconds connect_limit{5000};
};

/// Used on its executor only, one next() at a time.
class Client {
public:
    /// Connects at the first next().
    Client(boost::asio::any_io_executor executor, StreamUrl url, ClientOptions options = {});
    /// No next() may be under way.
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    /// Waits for the next event, for as long as the gateway has nothing to say. Who does not call
    /// it loses frames, the oldest first, and learns how many.
    /// Errors: no connection, as options.reconnect has it; after cancel()
    /// boost::asio::error::operation_aborted. The Problem says what stands in the way and what to
    /// do.
    boost::asio::awaitable<Result<Event, Problem>> next();

    /// Says what to get from now on, also after a reconnect; none: states only. The answer comes as
    /// an event. A wish for a lidar that the gateway does not know (yet, as after its restart) is
    /// refused, and repeated by itself when the lidar appears.
    boost::asio::awaitable<void> set_wish(std::optional<v1::Subscribe> wish);

    /// Gives the connection up for what came over it, as if it had ended by that; it is tried again
    /// after the longest wait.
    void give_up(Problem why);

    /// Ends the connection and a next() under way; for good.
    void cancel();

    /// Lidars, states and frames left out so far, over all connections (see LeftOut).
    [[nodiscard]] std::uint64_t left_out() const;

    /// Bytes received so far, over all connections, framing included.
    [[nodiscard]] std::uint64_t bytes_received() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace sweepcast::client
