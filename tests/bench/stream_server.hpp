// What the benchmarks of the stream serve with: the gateway's own listeners, sessions and hub,
// without lidars; frames come from the benchmark.
#pragma once

#include "driver/async/worker.hpp"
#include "server/api/api.hpp"
#include "server/frame/wire_message.hpp"
#include "server/http/host_names.hpp"
#include "server/hub/hub.hpp"
#include "server/net/listener.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace sweepcast::bench {

/// A ServerMessage with a frame in it, of exactly `size` bytes where possible.
[[nodiscard]] frame::WireMessagePtr make_frame(std::uint64_t sequence, std::size_t size);

/// Listens on ports of its own until it is destroyed.
class StreamServer {
public:
    explicit StreamServer(std::size_t workers, hub::MailboxLimits mailbox = {});
    ~StreamServer();
    StreamServer(const StreamServer&) = delete;
    StreamServer& operator=(const StreamServer&) = delete;

    /// Gives a sweep of lidar 1 to all who want it.
    void publish(const frame::WireMessagePtr& frame);

    [[nodiscard]] std::uint16_t http_port() const { return http_->endpoint().port(); }
    [[nodiscard]] std::uint16_t tcp_port() const { return tcp_->endpoint().port(); }
    /// How many clients want frames.
    [[nodiscard]] std::uint32_t subscribers();

private:
    net::Workers workers_;
    std::unique_ptr<hub::Hub> hub_;
    std::unique_ptr<api::LidarControl> control_;
    http::HostNames host_names_{{}};  // clients come by address
    std::vector<api::Api> apis_;
    std::unique_ptr<net::Listener> http_;
    std::unique_ptr<net::Listener> tcp_;
};

}  // namespace sweepcast::bench
