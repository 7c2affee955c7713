// LidarPort: where a lidar of the gateway is, how it is reached, and when it is worth another try.
#pragma once

#include "driver/link/link.hpp"
#include "driver/link/link_url.hpp"
#include "driver/link/path_watch.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

namespace sweepcast::gateway {

/// Used on one executor.
class LidarPort {
public:
    LidarPort(boost::asio::any_io_executor executor, link::LinkUrl way);

    [[nodiscard]] const link::LinkUrl& way() const { return way_; }

    /// Opens it, at `baud` if it has a speed. Errors: those of link::open_link().
    boost::asio::awaitable<Result<std::unique_ptr<link::Link>, Problem>> open(std::uint32_t baud);

    /// Returns when the device file is not what it was when open() was last begun: it came, went,
    /// is another one or may be opened by others; at `deadline` at the latest, and on a network
    /// then.
    boost::asio::awaitable<void> wait_for_change(std::chrono::steady_clock::time_point deadline);

private:
    boost::asio::any_io_executor executor_;
    link::LinkUrl way_;
    std::optional<link::PathLook> tried_;  ///< the device file, when open() was last begun
};

}  // namespace sweepcast::gateway
