#include "tests/driver/device/memory_link.hpp"

#include "driver/link/error.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <algorithm>
#include <utility>

namespace sweepcast::device {

namespace asio = boost::asio;

MemoryLink::MemoryLink(Line& line) : line_(line) {
    line_.unplugged = false;
    line_.interrupted = false;
    line_.to_host.clear();
}

asio::awaitable<Result<std::size_t>>
MemoryLink::read_some(std::span<std::uint8_t> into, link::Deadline deadline) {
    while (line_.to_host.empty()) {
        if (line_.unplugged) {
            co_return make_error_code(link::errc::disconnected);
        }
        if (std::exchange(line_.interrupted, false)) {
            co_return make_error_code(link::errc::interrupted);
        }
        if (line_.babbles) {
            co_await asio::post(asio::use_awaitable);
            line_.to_host.push_back(0);
            break;
        }
        const bool changed = co_await line_.changed.wait_until(deadline);
        if (!changed) {
            co_return make_error_code(link::errc::timed_out);
        }
    }
    const auto count = std::min(into.size(), line_.to_host.size());
    const auto end = line_.to_host.begin() + static_cast<std::ptrdiff_t>(count);
    std::copy(line_.to_host.begin(), end, into.begin());
    line_.to_host.erase(line_.to_host.begin(), end);
    co_return count;
}

asio::awaitable<Result<void>>
MemoryLink::write_all(std::span<const std::uint8_t> bytes, link::Deadline) {
    if (line_.unplugged) {
        co_return make_error_code(link::errc::disconnected);
    }
    line_.on_write(bytes);
    co_return Result<void>{};
}

void MemoryLink::interrupt() {
    line_.interrupted = true;
    line_.changed.notify();
}

Result<void> MemoryLink::set_dtr(bool asserted) {
    if (!line_.has_dtr) {
        return make_error_code(link::errc::no_modem_lines);
    }
    line_.dtr = asserted;
    return {};
}

Result<void> MemoryLink::set_baud(std::uint32_t baud) {
    if (is_network()) {
        return make_error_code(link::errc::no_line_speed);
    }
    if (std::ranges::find(line_.refused_bauds, baud) != line_.refused_bauds.end()) {
        return make_error_code(link::errc::baud_not_supported);
    }
    line_.baud = baud;
    flush_input();
    return {};
}

}  // namespace sweepcast::device
