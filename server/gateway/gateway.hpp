// Gateway: everything that runs, and the order in which it starts and stops.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/api/api.hpp"
#include "server/gateway/gateway_lidar.hpp"
#include "server/gateway/lidar_ids.hpp"
#include "server/gateway/lidar_memory.hpp"
#include "server/gateway/lidar_ports.hpp"
#include "server/gateway/lidar_url.hpp"
#include "server/gateway/managed_lidar.hpp"
#include "server/gateway/virtual_lidars.hpp"
#include "server/http/host_names.hpp"
#include "server/hub/hub.hpp"
#include "server/net/listener.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <spdlog/logger.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sweepcast::gateway {

struct GatewayOptions {
    boost::asio::ip::tcp::endpoint http;
    boost::asio::ip::tcp::endpoint tcp;
    std::vector<LidarUrl> lidars;
    /// Ports at which to look, besides USB ones, for a lidar that left its own.
    std::vector<std::string> patterns;
    device::DeviceOptions device;
    /// What is known of line speeds, and what is learnt of them.
    std::shared_ptr<LidarMemory> memory{std::make_shared<LidarMemory>()};
    /// Names under which clients address the gateway, besides those of its machine.
    std::vector<std::string> host_names;
    /// Threads for lidars and clients.
    std::size_t threads{1};
    /// Most connections at a time, for HTTP and TCP each.
    std::size_t max_connections{10'000};
    hub::MailboxLimits mailbox{};
};

/// Makes the logger for a part of the gateway, by the part's name.
using MakeLogger = std::function<std::shared_ptr<spdlog::logger>(const std::string& part)>;

/// One process's gateway. start() and stop() are to be called on one thread that is none of its
/// workers'.
class Gateway final : private api::LidarControl {
public:
    /// Starts everything. The Problem says what cannot be had: an address, a lidar URL's file;
    /// nothing runs then.
    static Result<std::unique_ptr<Gateway>, Problem>
    start(GatewayOptions options, const MakeLogger& make_logger);

    /// As stop().
    ~Gateway() override;

    /// Stops accepting, then the lidars (motors off), then the sessions (which are told why), then
    /// the threads. Takes at most about a second; says in the log what did not end in time.
    void stop();

    [[nodiscard]] boost::asio::ip::tcp::endpoint http_endpoint() const { return http_->endpoint(); }
    [[nodiscard]] boost::asio::ip::tcp::endpoint tcp_endpoint() const { return tcp_->endpoint(); }

private:
    Gateway(GatewayOptions options, const MakeLogger& make_logger);

    Result<void, Problem> add_lidars(const MakeLogger& make_logger);
    [[nodiscard]] device::DeviceOptions options_for(const LidarUrl& url) const;
    void
    add_remote(const LidarUrl& url, const RemoteLidarUrl& remote, const MakeLogger& make_logger);
    [[nodiscard]] bool is_own(const RemoteLidarUrl& remote) const;
    [[nodiscard]] std::optional<Problem> own_upstream() const;
    Result<LidarPlace, Problem>
    place(const LidarUrl& url, std::uint32_t number, const MakeLogger& make_logger);
    Result<void, Problem> set_up(const MakeLogger& make_logger);
    Result<void, Problem> listen(const MakeLogger& make_logger);
    void stop_lidars();
    void end_sessions();

    boost::asio::awaitable<Outcome> start(std::uint32_t lidar, std::string mode) override;
    boost::asio::awaitable<Outcome> stop(std::uint32_t lidar) override;
    boost::asio::awaitable<Outcome> reset(std::uint32_t lidar) override;
    boost::asio::awaitable<Outcome> update(std::uint32_t lidar, api::LidarUpdate update) override;
    boost::asio::awaitable<Result<device::Diagnosis, Problem>> diagnose(std::uint32_t lidar
    ) override;

    GatewayOptions options_;
    std::shared_ptr<spdlog::logger> log_;
    net::Workers workers_;
    std::unique_ptr<hub::Hub> hub_;
    http::HostNames hosts_;
    LidarIds ids_;
    VirtualLidars virtual_lidars_;
    LidarPorts ports_;
    std::vector<std::unique_ptr<GatewayLidar>> lidars_;
    std::vector<api::Api> apis_;  ///< one a worker
    std::unique_ptr<net::Listener> http_;
    std::unique_ptr<net::Listener> tcp_;
    bool stopped_{};
};

}  // namespace sweepcast::gateway
