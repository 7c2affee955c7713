// Which lidars `serve` takes: those named, those found, or else a virtual one.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/gateway/lidar_memory.hpp"
#include "server/gateway/lidar_url.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <spdlog/logger.h>

#include <memory>
#include <string>
#include <vector>

namespace sweepcast::cli {

struct LidarChoice {
    std::vector<gateway::LidarUrl> lidars;
    std::vector<std::string> patterns;  ///< of ports to look at, told by the user
    bool find{};                        ///< whether to look for more
};

/// Reads --lidar and the patterns of --discover. Lidars are looked for if none is named, or if
/// patterns are given. Two names for one port or host are taken as one lidar, which the log says.
Result<LidarChoice, Problem> choose_lidars(
    const std::vector<std::string>& named,
    std::vector<std::string> patterns,
    const std::shared_ptr<spdlog::logger>& log
);

/// The patterns in the environment's SWEEPCAST_DISCOVER, with ':' between them.
std::vector<std::string> patterns_of_environment();

/// Adds the lidars that answer on this machine's ports to `choice`, but for one that `memory` knows
/// as a lidar that is named and whose own port is not there. The log says what was looked at, and
/// why other ports were not. Line speeds that `memory` knows are tried first.
boost::asio::awaitable<void> find_lidars(
    boost::asio::any_io_executor executor,
    std::shared_ptr<spdlog::logger> log,
    const gateway::LidarMemory& memory,
    LidarChoice& choice
);

/// A virtual lidar for a choice that is empty, with a warning: the first one that is plugged in
/// takes its place.
void stand_in_for_none(LidarChoice& choice, spdlog::logger& log);

}  // namespace sweepcast::cli
