// LidarPort: where a lidar of the gateway is, how it is reached, and when it is worth another try.
#pragma once

#include "driver/async/notifier.hpp"
#include "driver/link/link.hpp"
#include "driver/link/link_url.hpp"
#include "driver/link/path_watch.hpp"
#include "driver/protocol/reply.hpp"
#include "driver/protocol/result.hpp"
#include "server/gateway/lidar_memory.hpp"
#include "server/gateway/lidar_ports.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace sweepcast::gateway {

/// Used on one executor, by one lidar.
class LidarPort {
public:
    /// A place that stays what it is: on the network, or a virtual lidar's.
    LidarPort(boost::asio::any_io_executor executor, link::LinkUrl way);
    /// A serial port; `ports` tells when its lidar, number `number`, is at another. The one that
    /// is `remembered` is expected there, or whoever is there.
    LidarPort(
        boost::asio::any_io_executor executor,
        link::LinkUrl way,
        LidarPorts& ports,
        std::uint32_t number,
        std::optional<RememberedLidar> remembered = {}
    );
    /// The port of a virtual lidar that stands in for one. Once `ports` has a lidar for its place,
    /// number `number`, it is the port of that, and `on_taken` is called, on any thread.
    LidarPort(
        boost::asio::any_io_executor executor,
        link::LinkUrl way,
        LidarPorts& ports,
        std::uint32_t number,
        std::function<void()> on_taken
    );
    LidarPort(const LidarPort&) = delete;
    LidarPort& operator=(const LidarPort&) = delete;

    [[nodiscard]] const link::LinkUrl& way() const { return way_; }
    /// The path of the serial port that it is now; empty on a network.
    [[nodiscard]] std::string path() const;

    /// Opens it, at `baud` if it has a speed. Errors: those of link::open_link().
    boost::asio::awaitable<Result<std::unique_ptr<link::Link>, Problem>> open(std::uint32_t baud);

    /// The line speed at which the lidar was found where it is now; 0: it was not, or has been met
    /// there since.
    [[nodiscard]] std::uint32_t baud_hint() const { return found_at_; }

    /// Whether the lidar is elsewhere since open() was last called.
    [[nodiscard]] bool has_moved() const;

    /// Whether the lidar that answers there is the one expected, or is taken for want of that (see
    /// LidarPorts::is_it).
    [[nodiscard]] bool is_it(const protocol::DeviceInfo& info);

    /// Returns when the device file is not what it was when open() was last begun: it came, went,
    /// is another one or may be opened by others, or the lidar was found elsewhere; at `deadline`
    /// at the latest, and on a network then.
    boost::asio::awaitable<void> wait_for_change(std::chrono::steady_clock::time_point deadline);

private:
    bool follow();

    boost::asio::any_io_executor executor_;
    link::LinkUrl way_;
    LidarPorts* ports_{};
    std::uint32_t number_{};
    std::uint32_t baud_{};                 ///< at which it was last opened
    std::uint32_t found_at_{};             ///< as baud_hint()
    bool refused_{};                       ///< another lidar was there
    std::optional<link::PathLook> tried_;  ///< the device file, when open() was last begun
    async::Notifier changed_;
};

}  // namespace sweepcast::gateway
