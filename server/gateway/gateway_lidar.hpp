// GatewayLidar: what the gateway needs of a lidar, whether on a port of its own or at another
// gateway.
#pragma once

#include "driver/async/worker.hpp"
#include "driver/device/diagnosis.hpp"
#include "driver/protocol/result.hpp"
#include "server/api/api.hpp"
#include "server/hub/lidar_snapshot.hpp"

#include <boost/asio/awaitable.hpp>

#include <future>
#include <string>

namespace sweepcast::gateway {

/// Belongs to its worker: after start() everything but stopped() runs there.
class GatewayLidar {
public:
    using Done = boost::asio::awaitable<Result<void, Problem>>;

    virtual ~GatewayLidar() = default;

    /// Begins the lidar's life. From any thread.
    virtual void start() = 0;
    /// Ends it. From any thread; stopped() tells when.
    virtual void shut_down() = 0;
    /// Becomes ready when the life begun by start() has ended.
    [[nodiscard]] virtual std::future<void>& stopped() = 0;
    [[nodiscard]] virtual bool started() const = 0;

    [[nodiscard]] virtual async::Worker& worker() = 0;
    [[nodiscard]] virtual hub::LidarSnapshotPtr snapshot() const = 0;

    /// The commands of the API. Besides their errors: device::errc::pending if the lidar cannot
    /// obey now, and will as soon as it can.
    virtual Done start_scan(std::string mode) = 0;
    virtual Done stop_scan() = 0;
    virtual Done reset() = 0;
    /// Changes what is given, or nothing if the lidar refuses a part of it.
    virtual Done update(api::LidarUpdate update) = 0;
    /// What is wrong with the lidar: told from its state if it is in hand, else by examining it.
    virtual boost::asio::awaitable<Result<device::Diagnosis, Problem>> diagnose() = 0;
};

}  // namespace sweepcast::gateway
