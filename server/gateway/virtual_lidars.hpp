// VirtualLidars: the virtual lidars that the gateway starts itself, on a thread of their own so
// that neither side's work shows in the other's timing.
#pragma once

#include "driver/async/worker.hpp"
#include "driver/protocol/result.hpp"
#include "driver/virtual/virtual_lidar.hpp"
#include "server/gateway/lidar_url.hpp"

#include <boost/asio/awaitable.hpp>
#include <spdlog/logger.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace sweepcast::gateway {

class VirtualLidars {
public:
    explicit VirtualLidars(async::TaskGroup::OnFailure on_failure)
        : on_failure_(std::move(on_failure)) {}
    ~VirtualLidars() { stop(); }

    /// Starts one and returns the path of its port; of one that may be unplugged that of a link,
    /// which is the same again when it is plugged in. `number` makes its serial number and its
    /// noise its own. The Problem says what is wrong with the URL's parameters.
    Result<std::string, Problem>
    add(const VirtualLidarUrl& url, std::uint32_t number, std::shared_ptr<spdlog::logger> log);

    /// Ends lidar `number`: its port hangs up and is gone soon. Safe from any thread, until stop().
    void end(std::uint32_t number);

    /// Ends them all.
    void stop();

private:
    boost::asio::awaitable<void> play(std::uint32_t number, virtual_lidar::VirtualLidar& lidar);
    Result<std::string, Problem> link_for(std::uint32_t number);

    async::TaskGroup::OnFailure on_failure_;
    std::string links_;  ///< folder for the links of those that have one; empty: not made yet
    std::mutex mutex_;   ///< of the map; each lidar is the worker's
    std::map<std::uint32_t, std::unique_ptr<virtual_lidar::VirtualLidar>> lidars_;
    std::unique_ptr<async::Worker> worker_;  ///< made for the first one
};

}  // namespace sweepcast::gateway
