// ManagedLidar: a lidar on a port of the gateway. Runs its device on one worker and publishes what
// it sees.
#pragma once

#include "driver/async/worker.hpp"
#include "driver/device/device.hpp"
#include "server/gateway/gateway_lidar.hpp"
#include "server/gateway/lidar_ids.hpp"
#include "server/gateway/lidar_memory.hpp"
#include "server/gateway/lidar_port.hpp"
#include "server/hub/hub.hpp"
#include "server/hub/lidar_frames.hpp"

#include <spdlog/logger.h>

#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>

namespace sweepcast::gateway {

/// What the gateway knows of a lidar before it has been asked anything.
struct LidarPlace {
    std::uint32_t number{};
    std::string url;
    std::string name;  ///< that its user gave it; empty: it goes by its serial number
    std::string port_name;
    std::string home{};  ///< the serial port by which its user names it; empty: nobody did
    bool is_virtual{};
    bool is_stand_in{};
    std::unique_ptr<LidarPort> port;  ///< on the executor of the lidar's worker
    /// How long it turns on when nobody watches; none: always.
    std::optional<std::chrono::seconds> motor_off_after{};
};

class ManagedLidar final : public GatewayLidar, private device::DeviceObserver {
public:
    ManagedLidar(
        LidarPlace place,
        device::DeviceOptions options,
        async::Worker& worker,
        hub::Hub& hub,
        LidarIds& ids,
        LidarMemory& memory,
        std::shared_ptr<spdlog::logger> log
    );

    void start() override;
    /// Scan stopped, motor off, port closed.
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
    [[nodiscard]] Result<void, Problem> obeyed(Result<void, Problem> done) const;
    void on_state(const device::DeviceState& state) override;
    void follow_port(const std::optional<protocol::DeviceInfo>& info);
    void remember(const device::DeviceState& state);
    void claim_id(const std::optional<protocol::DeviceInfo>& info);
    void on_sweep(device::CapturedSweep sweep) override;
    void on_progress(const device::SweepProgress& progress) override;
    boost::asio::awaitable<void> live();
    boost::asio::awaitable<void> obey_demand(std::chrono::seconds patience);

    LidarPlace place_;
    async::Worker& worker_;
    hub::Hub& hub_;
    LidarIds& ids_;
    LidarMemory& memory_;
    std::shared_ptr<spdlog::logger> log_;
    hub::LidarFrames frames_;
    hub::LidarSnapshotPtr snapshot_;
    std::string id_;
    std::string path_;       ///< of its serial port, as place_ tells it
    std::string named_for_;  ///< the serial number that id_ comes from; empty: the port's name
    bool started_{};
    std::promise<void> ended_;
    std::future<void> stopped_;
    device::Device device_;
};

}  // namespace sweepcast::gateway
