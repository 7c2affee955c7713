// BareWebsockets: sessions as Beast's examples write them, for comparison: a stream, a buffer and a
// coroutine each, and nothing else.
#pragma once

#include "driver/async/worker.hpp"
#include "server/frame/wire_message.hpp"
#include "server/net/listener.hpp"

#include <cstdint>
#include <memory>

namespace sweepcast::bench {

/// Listens on a port of its own until it is destroyed; sends each client one message, then listens
/// to it.
class BareWebsockets {
public:
    explicit BareWebsockets(frame::WireMessagePtr message);
    ~BareWebsockets();
    BareWebsockets(const BareWebsockets&) = delete;
    BareWebsockets& operator=(const BareWebsockets&) = delete;

    [[nodiscard]] std::uint16_t port() const { return listener_->endpoint().port(); }

private:
    net::Workers workers_;
    std::unique_ptr<net::Listener> listener_;
};

}  // namespace sweepcast::bench
