// RemoteLidar: a lidar of another gateway, published here as if it were this
// one's. One connection, whatever the number of subscribers here.
#pragma once

#include "server/client/client.hpp"
#include "server/client/sweep_joiner.hpp"
#include "server/gateway/gateway_lidar.hpp"
#include "server/gateway/lidar_ids.hpp"
#include "server/gateway/lidar_url.hpp"
#include "server/gateway/remote_clock.hpp"
#include "server/hub/hub.hpp"
#include "server/hub/lidar_frames.hpp"
#include "server/net/once_per_second.hpp"

#include <spdlog/logger.h>

#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace sweepcast::gateway {

/// Where a remote lidar is, and how it is to be called here.
struct RemotePlace {
    std::uint32_t number{};
    std::string url;   ///< as the user wrote it
    std::string name;  ///< that its user gave it; empty: it goes by the id it has there
    std::string port_name;
    RemoteLidarUrl where;
};

/// Samples, flags, qualities, losses and sequence numbers are those of the
/// other gateway, UNIX times too. Times on the monotonic clock are brought to
/// this machine's by RemoteClock, the same for all samples of a sweep. Its
/// sectors come as sectors (one for each 30 degrees) and are joined to sweeps:
/// a sweep of which one is missing is left out, and the gap in the sequence
/// shows it. The state is the other gateway's; while that cannot be reached,
/// `backing_off` with the cause. Its URL is told as "<where it is there> via <where
/// we have it from>". Commands are refused: they are for its own gateway.
class RemoteLidar final : public GatewayLidar {
public:
    RemoteLidar(
        RemotePlace place,
        async::Worker& worker,
        hub::Hub& hub,
        LidarIds& ids,
        std::shared_ptr<spdlog::logger> log
    );

    void start() override;
    void shut_down() override;
    [[nodiscard]] std::future<void>& stopped() override { return stopped_; }
    [[nodiscard]] bool started() const override { return started_; }
    [[nodiscard]] async::Worker& worker() override { return worker_; }
    [[nodiscard]] hub::LidarSnapshotPtr snapshot() const override { return snapshot_; }

    Done start_scan(std::string mode) override;
    Done stop_scan() override;
    Done reset() override;
    Done update(api::LidarUpdate update) override;
    boost::asio::awaitable<Result<device::Diagnosis, Problem>> diagnose() override;

private:
    boost::asio::awaitable<void> live();

    void take(const client::Connected& connected);
    void take(const client::Disconnected& disconnected);
    void take(client::Scan scan);
    void take(const v1::Lidar& lidar);
    void take(const v1::StreamError& refusal);
    void take(const v1::Subscribed& subscribed);
    void take(const v1::StreamStats& stats);
    void take(const client::LeftOut& left_out);

    void choose();
    void mirror(const v1::Lidar& lidar);
    void claim_id(const v1::Lidar& lidar);
    void publish_sweep(protocol::SampleTime arrival);
    void fail(const Problem& why);
    [[nodiscard]] bool fails_by(const Problem& why) const;
    void log_failure(const Problem& why);
    void publish_failure(const Problem& why);
    void give_up(Problem why);
    void publish(hub::LidarSnapshot snapshot);
    [[nodiscard]] Problem controlled_elsewhere() const;

    RemotePlace place_;
    async::Worker& worker_;
    hub::Hub& hub_;
    LidarIds& ids_;
    std::shared_ptr<spdlog::logger> log_;
    std::unique_ptr<client::Client> client_;  ///< null: the life has ended
    hub::LidarFrames frames_;
    /// The other gateway's lidars, by number. The client bounds how many, and the memory of each.
    std::map<std::uint32_t, v1::Lidar> there_;
    std::optional<std::uint32_t> chosen_;    ///< which of them it is
    std::optional<v1::Subscribe> due_wish_;  ///< to be sent
    /// The other gateway refused the wish: there are no frames, whatever the state there.
    bool is_refused_{};
    // Log lines only, so that the other gateway cannot fill the log:
    net::OncePerSecond refusals_;
    net::OncePerSecond losses_;
    RemoteClock clock_;
    std::chrono::microseconds offset_{};  ///< of the sweep under way
    client::SweepJoiner joiner_;
    hub::LidarSnapshotPtr snapshot_;
    std::string id_;
    std::string claimed_;  ///< the id there that id_ comes from
    bool started_{};
    std::promise<void> ended_;
    std::future<void> stopped_;
};

}  // namespace sweepcast::gateway
