// Probe: is there a lidar at this port, and which one?
#pragma once

#include "driver/device/conversation.hpp"
#include "driver/device/identify.hpp"
#include "driver/link/link_url.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <spdlog/logger.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace sweepcast::device {

/// A lidar as it was met.
struct Probed {
    Identity identity;
    std::uint32_t baud{};  ///< at which it answered; 0: a network
};

/// Opens the link, finds the line speed (trying the one in the URL alone if it has one, else
/// `baud_hints` and then the usual ones), identifies what is there and closes it again. A scan that
/// was running is ended and the motor stopped. The Problem says why there is no answer and what to
/// do.
boost::asio::awaitable<Result<Probed, Problem>> probe(
    boost::asio::any_io_executor executor,
    link::LinkUrl url,
    std::vector<std::uint32_t> baud_hints
);

/// The line speeds at which a lidar at `url` is looked for, the first ones first: the one in the
/// URL alone if it has one, else `hints` and then the usual ones.
[[nodiscard]] std::vector<std::uint32_t>
bauds_for(const link::LinkUrl& url, const std::vector<std::uint32_t>& hints);

/// As probe(), over a link to `url` that is open and stays so, at the speed of the lidar. `bauds`
/// are the line speeds to try.
boost::asio::awaitable<Result<Probed, Problem>>
probe_open(Conversation& talk, link::LinkUrl url, std::vector<std::uint32_t> bauds);

/// A port where a lidar answered.
struct Discovered {
    std::string path;
    std::string serial;  ///< as protocol::serial_text() writes it
    std::uint32_t baud{};
};

/// Line speeds at which a lidar was met before on the port of that path.
using BaudHints = std::function<std::vector<std::uint32_t>(const std::string& path)>;

/// Asks each of the serial ports `paths`, once, and gives those where a lidar answered. A port in
/// use is left alone.
boost::asio::awaitable<std::vector<Discovered>> discover(
    boost::asio::any_io_executor executor,
    std::vector<std::string> paths,
    BaudHints hints,
    std::shared_ptr<spdlog::logger> log
);

}  // namespace sweepcast::device
