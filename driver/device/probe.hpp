// Probe: is there a lidar at this port, and which one?
#pragma once

#include "driver/device/identify.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <spdlog/logger.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace sweepcast::device {

/// The line speed of an A1, and of older A2s (protocol.md 6).
constexpr std::uint32_t default_baud = 115200;

/// Opens the port, identifies what is there and closes it again. A scan that was running is ended.
/// The Problem says why there is no answer and what to do.
boost::asio::awaitable<Result<Identity, Problem>>
probe(boost::asio::any_io_executor executor, std::string path, std::uint32_t baud);

/// Asks every serial port whose USB adapter is of the kind that RPLIDARs come with, once, and
/// returns the ports where a lidar answered. Ports of other adapters, and ports in use, are left
/// alone.
boost::asio::awaitable<std::vector<std::string>>
discover(boost::asio::any_io_executor executor, std::shared_ptr<spdlog::logger> log);

}  // namespace sweepcast::device
