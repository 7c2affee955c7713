#include "server/gateway/lidar_port.hpp"

#include "driver/async/notifier.hpp"
#include "driver/link/open_link.hpp"

#include <utility>

namespace sweepcast::gateway {

namespace asio = boost::asio;

LidarPort::LidarPort(asio::any_io_executor executor, link::LinkUrl way)
    : executor_(std::move(executor))
    , way_(std::move(way)) {}

asio::awaitable<Result<std::unique_ptr<link::Link>, Problem>> LidarPort::open(std::uint32_t baud) {
    if (const auto* serial = std::get_if<link::SerialPlace>(&way_.where)) {
        tried_.emplace(serial->path);
    }
    co_return co_await link::open_link(executor_, way_, baud);
}

asio::awaitable<void> LidarPort::wait_for_change(std::chrono::steady_clock::time_point deadline) {
    async::Notifier changed(executor_);
    const auto* serial = std::get_if<link::SerialPlace>(&way_.where);
    if (serial == nullptr || !tried_) {
        co_await changed.wait_until(deadline);
        co_return;
    }
    const link::PathWatch watch(executor_, serial->path, [&changed] { changed.notify(); });
    bool in_time = true;
    while (in_time && link::PathLook(serial->path) == *tried_) {
        in_time = co_await changed.wait_until(deadline);
    }
}

}  // namespace sweepcast::gateway
