// Reading and writing a descriptor with deadlines, interrupts and cancellation.
#include "driver/link/descriptor_link.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <array>
#include <cerrno>
#include <optional>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utility>

namespace sweepcast::link {

namespace asio = boost::asio;

namespace {

constexpr auto as_awaitable_tuple = asio::as_tuple(asio::use_awaitable);

/// What the system says when a device goes away, in our word for it; anything else as it is.
error_code translate(const error_code& ec) {
    if (ec == asio::error::eof) {
        return errc::disconnected;
    }
    if (ec.category() == boost::system::system_category()) {
        switch (ec.value()) {
        case EIO:
        case ENXIO:
        case ENODEV:
        case EPIPE:
        case ECONNRESET:
        case EBADF:
            return errc::disconnected;
        default:
            break;
        }
    }
    return ec;
}

error_code last_system_error() {
    return {errno, boost::system::system_category()};
}

}  // namespace

/// Marks a direction as busy while it lives, and knows when to give up.
class DescriptorLink::Operation {
public:
    Operation(DescriptorLink& link, Direction& direction, Deadline deadline)
        : link_(link)
        , direction_(direction)
        , was_open_(link.descriptor_.is_open()) {
        direction_.pending = true;
        if (was_open_) {
            direction_.timer.start(deadline);
        }
    }
    Operation(const Operation&) = delete;
    Operation& operator=(const Operation&) = delete;
    ~Operation() {
        direction_.timer.finish();
        direction_.pending = false;
    }

    /// Why the operation must not go on, if so. An interrupt counts once.
    std::optional<error_code> reason_to_stop() {
        if (!link_.descriptor_.is_open()) {
            return was_open_ ? errc::interrupted : errc::disconnected;
        }
        if (std::exchange(direction_.interrupted, false)) {
            return errc::interrupted;
        }
        if (direction_.timer.expired()) {
            return errc::timed_out;
        }
        return std::nullopt;
    }

private:
    DescriptorLink& link_;
    Direction& direction_;
    bool was_open_;
};

DescriptorLink::DescriptorLink(asio::posix::stream_descriptor descriptor, std::uint32_t baud)
    : descriptor_(std::move(descriptor))
    , baud_(baud)
    , reading_{.timer{descriptor_.get_executor(), [this] { cancel_pending(); }}}
    , writing_{.timer{descriptor_.get_executor(), [this] { cancel_pending(); }}} {}

DescriptorLink::~DescriptorLink() {
    DescriptorLink::close();
}

asio::awaitable<Result<std::size_t>>
DescriptorLink::read_some(std::span<std::uint8_t> into, Deadline deadline) {
    if (into.empty()) {
        co_return std::size_t{0};
    }
    Operation operation(*this, reading_, deadline);
    for (;;) {
        if (const auto reason = operation.reason_to_stop()) {
            if (*reason == errc::timed_out) {
                co_return read_what_is_there(into);
            }
            co_return *reason;
        }
        const auto buffer = asio::buffer(into.data(), into.size());
        const auto [ec, count] = co_await descriptor_.async_read_some(buffer, as_awaitable_tuple);
        if (!ec) {
            co_return count;
        }
        if (ec != asio::error::operation_aborted) {
            co_return translate(ec);
        }
        if ((co_await asio::this_coro::cancellation_state).cancelled() !=
            asio::cancellation_type::none) {
            co_return errc::interrupted;
        }
    }
}

Result<std::size_t> DescriptorLink::read_what_is_there(std::span<std::uint8_t> into) {
    const auto count = ::read(descriptor_.native_handle(), into.data(), into.size());
    return count > 0 ? Result<std::size_t>(static_cast<std::size_t>(count))
                     : error_code(errc::timed_out);
}

asio::awaitable<Result<void>>
DescriptorLink::write_all(std::span<const std::uint8_t> bytes, Deadline deadline) {
    Operation operation(*this, writing_, deadline);
    while (!bytes.empty()) {
        if (const auto reason = operation.reason_to_stop()) {
            co_return *reason;
        }
        const auto buffer = asio::buffer(bytes.data(), bytes.size());
        const auto [ec, count] = co_await descriptor_.async_write_some(buffer, as_awaitable_tuple);
        bytes = bytes.subspan(count);
        if (ec && ec != asio::error::operation_aborted) {
            co_return translate(ec);
        }
        if (ec && (co_await asio::this_coro::cancellation_state).cancelled() !=
                      asio::cancellation_type::none) {
            co_return errc::interrupted;
        }
    }
    co_return Result<void>{};
}

void DescriptorLink::interrupt() {
    reading_.interrupted = true;
    cancel_pending();
}

void DescriptorLink::cancel_pending() {
    error_code ignored;  // fails on a closed descriptor only, which has nothing pending
    descriptor_.cancel(ignored);
}

Result<void> DescriptorLink::set_dtr(bool asserted) {
    if (!descriptor_.is_open()) {
        return error_code(errc::disconnected);
    }
    const int line = TIOCM_DTR;
    if (::ioctl(descriptor_.native_handle(), asserted ? TIOCMBIS : TIOCMBIC, &line) == 0) {
        return {};
    }
    // A pty has no ioctl for it (ENOTTY), a driver without modem lines says EINVAL.
    if (errno == ENOTTY || errno == EINVAL) {
        return error_code(errc::no_modem_lines);
    }
    return translate(last_system_error());
}

void DescriptorLink::flush_input() {
    if (!descriptor_.is_open()) {
        return;
    }
    // Read rather than tcflush(): that leaves behind what the kernel's line discipline has not seen
    // yet. Bounded, so that a device faster than we are cannot hold us here.
    constexpr int most_reads = 64;
    std::array<std::uint8_t, 4096> discarded{};
    for (int i = 0; i < most_reads; ++i) {
        if (::read(descriptor_.native_handle(), discarded.data(), discarded.size()) <= 0) {
            return;
        }
    }
}

void DescriptorLink::close() {
    if (!descriptor_.is_open()) {
        return;
    }
    // A pty that lives on in its other holders would stay exclusive.
    (void)::ioctl(descriptor_.native_handle(), TIOCNXCL);  // not a terminal: nothing to undo
    error_code ignored;  // the descriptor is gone even if closing reports an error
    descriptor_.close(ignored);
    reading_.timer.stop();
    writing_.timer.stop();
}

}  // namespace sweepcast::link
