#include "driver/link/tee_link.hpp"

#include <utility>

namespace sweepcast::link {

namespace asio = boost::asio;

TeeLink::TeeLink(std::unique_ptr<Link> inner, LinkTap& tap) : inner_(std::move(inner)), tap_(tap) {}

asio::awaitable<Result<std::size_t>>
TeeLink::read_some(std::span<std::uint8_t> into, Deadline deadline) {
    const auto count = co_await inner_->read_some(into, deadline);
    if (count && *count > 0) {
        tap_.on_read(into.first(*count));
    }
    co_return count;
}

asio::awaitable<Result<void>>
TeeLink::write_all(std::span<const std::uint8_t> bytes, Deadline deadline) {
    if (!bytes.empty()) {
        tap_.on_write(bytes);
    }
    co_return co_await inner_->write_all(bytes, deadline);
}

Result<void> TeeLink::set_baud(std::uint32_t baud) {
    auto set = inner_->set_baud(baud);
    if (set) {
        tap_.on_set_baud(baud);
    }
    return set;
}

}  // namespace sweepcast::link
