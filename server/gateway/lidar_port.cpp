#include "server/gateway/lidar_port.hpp"

#include "driver/link/open_link.hpp"

#include <boost/asio/post.hpp>

#include <utility>

namespace sweepcast::gateway {

namespace asio = boost::asio;

LidarPort::LidarPort(asio::any_io_executor executor, link::LinkUrl way)
    : executor_(executor)
    , way_(std::move(way))
    , changed_(std::move(executor)) {}

LidarPort::LidarPort(
    asio::any_io_executor executor,
    link::LinkUrl way,
    LidarPorts& ports,
    std::uint32_t number,
    std::optional<RememberedLidar> remembered
)
    : LidarPort(std::move(executor), std::move(way)) {
    ports_ = &ports;
    number_ = number;
    ports.add(
        number,
        path(),
        [this] { asio::post(executor_, [this] { changed_.notify(); }); },
        std::move(remembered)
    );
}

LidarPort::LidarPort(
    asio::any_io_executor executor,
    link::LinkUrl way,
    LidarPorts& ports,
    std::uint32_t number,
    std::function<void()> on_taken
)
    : LidarPort(std::move(executor), std::move(way)) {
    ports_ = &ports;
    number_ = number;
    ports.add_vacant(number, path(), [this, on_taken = std::move(on_taken)] {
        on_taken();
        asio::post(executor_, [this] { changed_.notify(); });
    });
}

std::string LidarPort::path() const {
    const auto* serial = std::get_if<link::SerialPlace>(&way_.where);
    return serial != nullptr ? serial->path : std::string();
}

asio::awaitable<Result<std::unique_ptr<link::Link>, Problem>> LidarPort::open(std::uint32_t baud) {
    if (ports_ != nullptr) {
        ports_->lost(number_);
        (void)follow();
    }
    tried_.emplace(path());
    baud_ = baud;
    refused_ = false;
    co_return co_await link::open_link(executor_, way_, baud);
}

bool LidarPort::has_moved() const {
    return ports_ != nullptr && ports_->path_of(number_) != path();
}

bool LidarPort::is_it(const protocol::DeviceInfo& info) {
    refused_ =
        ports_ != nullptr && !ports_->is_it(number_, path(), protocol::serial_text(info.serial));
    if (!refused_) {
        found_at_ = 0;
    }
    return !refused_;
}

asio::awaitable<void> LidarPort::wait_for_change(std::chrono::steady_clock::time_point deadline) {
    if (path().empty() || !tried_) {
        co_await changed_.wait_until(deadline);
        co_return;
    }
    const link::PathWatch watch(executor_, path(), [this] { changed_.notify(); });
    const link::PathLook now(path());
    if (ports_ != nullptr && (refused_ || !now.there())) {
        ports_->seek(number_, baud_);
    }
    bool in_time = true;
    while (in_time && !follow() && link::PathLook(path()) == *tried_) {
        in_time = co_await changed_.wait_until(deadline);
    }
}

/// Goes where the lidar is now. False if that is where it was.
bool LidarPort::follow() {
    if (!has_moved()) {
        return false;
    }
    const auto path = ports_->path_of(number_);
    std::get<link::SerialPlace>(way_.where).path = path;
    way_.text = path;
    found_at_ = ports_->baud_at_path(number_);
    return true;
}

}  // namespace sweepcast::gateway
