// BlockingClient: a subscriber of a gateway's stream, for programs with a thread to wait in.
// Reconnects by itself.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/client/client.hpp"

#include <chrono>
#include <memory>
#include <optional>

namespace sweepcast::client {

/// Everything but cancel() is for one thread at a time.
class BlockingClient {
public:
    /// Connects at the first next().
    explicit BlockingClient(StreamUrl url, ClientOptions options = {});
    ~BlockingClient();
    BlockingClient(const BlockingClient&) = delete;
    BlockingClient& operator=(const BlockingClient&) = delete;

    /// Waits for the next event; otherwise as Client::next().
    Result<Event, Problem> next();
    /// The same, but waits at most `limit`: none if nothing came.
    Result<std::optional<Event>, Problem> next(std::chrono::milliseconds limit);

    /// As Client::set_wish().
    void set_wish(std::optional<v1::Subscribe> wish);

    /// Ends the connection; a next() under way in another thread returns. For good.
    void cancel();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace sweepcast::client
