// TransportLink: what the links of every kind share: deadlines, interrupts and cancellation.
#pragma once

#include "driver/link/deadline_timer.hpp"
#include "driver/link/link.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <array>
#include <concepts>
#include <optional>
#include <tuple>
#include <utility>

namespace sweepcast::link {

inline constexpr auto as_awaitable_tuple = boost::asio::as_tuple(boost::asio::use_awaitable);

/// How one step of reading or writing ended, and how many bytes it moved.
using Transferred = std::tuple<error_code, std::size_t>;

/// What moves the bytes. A step that cancel() or close() ends reports operation_aborted, and has
/// then moved nothing. A read that ends without error and without bytes is begun anew.
template <class T>
concept Transport =
    requires(T& transport, std::span<std::uint8_t> into, std::span<const std::uint8_t> bytes) {
    { transport.executor() } -> std::convertible_to<boost::asio::any_io_executor>;
    { transport.is_open() } -> std::same_as<bool>;
    { transport.read_some(into) } -> std::same_as<boost::asio::awaitable<Transferred>>;
    { transport.write_some(bytes) } -> std::same_as<boost::asio::awaitable<Transferred>>;
    /// Reads what is there without waiting; 0 if there is nothing.
    { transport.read_now(into) } -> std::same_as<std::size_t>;
    transport.cancel();
    transport.close();
};

/// What the system says when a device goes away, in our word for it; anything else as it is.
error_code translate(const error_code& ec);

/// The operations of a Link over a transport, as link.hpp promises them.
template <Transport T>
class TransportLink : public Link {
public:
    explicit TransportLink(T transport)
        : transport_(std::move(transport))
        , reading_{.timer{transport_.executor(), [this] { transport_.cancel(); }}}
        , writing_{.timer{transport_.executor(), [this] { transport_.cancel(); }}} {}
    ~TransportLink() override { TransportLink::close(); }

    [[nodiscard]] boost::asio::awaitable<Result<std::size_t>>
    read_some(std::span<std::uint8_t> into, Deadline deadline) override;
    [[nodiscard]] boost::asio::awaitable<Result<void>>
    write_all(std::span<const std::uint8_t> bytes, Deadline deadline) override;
    /// A deadline or an interrupt ends whatever is pending on the transport; the operation that was
    /// not meant begins again, which loses nothing.
    void interrupt() override {
        reading_.interrupted = true;
        transport_.cancel();
    }
    void flush_input() override;
    void close() override;

protected:
    T& transport() { return transport_; }
    /// The device is gone, whether or not the transport has noticed: as close(), but pending
    /// operations end with errc::disconnected.
    void lose() {
        lost_ = true;
        TransportLink::close();
    }

private:
    /// Reading or writing: at most one operation of it is under way.
    struct Direction {
        DeadlineTimer timer;
        bool interrupted{};
    };
    class Operation;

    T transport_;
    bool lost_{};
    Direction reading_;
    Direction writing_;
};

/// One read or write: knows when to give up.
template <Transport T>
class TransportLink<T>::Operation {
public:
    Operation(TransportLink& link, Direction& direction, Deadline deadline)
        : link_(link)
        , direction_(direction)
        , was_open_(link.transport_.is_open()) {
        if (was_open_) {
            direction_.timer.start(deadline);
        }
    }
    Operation(const Operation&) = delete;
    Operation& operator=(const Operation&) = delete;
    ~Operation() { direction_.timer.finish(); }

    /// Why the operation must not go on, if so. An interrupt counts once.
    std::optional<error_code> reason_to_stop() {
        if (!link_.transport_.is_open()) {
            return was_open_ && !link_.lost_ ? errc::interrupted : errc::disconnected;
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
    TransportLink& link_;
    Direction& direction_;
    bool was_open_;
};

template <Transport T>
boost::asio::awaitable<Result<std::size_t>>
TransportLink<T>::read_some(std::span<std::uint8_t> into, Deadline deadline) {
    if (into.empty()) {
        co_return std::size_t{0};
    }
    Operation operation(*this, reading_, deadline);
    for (;;) {
        if (const auto reason = operation.reason_to_stop()) {
            if (*reason != errc::timed_out) {
                co_return *reason;
            }
            // The last look: bytes that came before the deadline may not have been announced yet
            // (the kernel hands them to a terminal's reader in the background, and this thread may
            // have been busy).
            const std::size_t count = transport_.read_now(into);
            co_return count > 0 ? Result<std::size_t>(count) : *reason;
        }
        const auto [ec, count] = co_await transport_.read_some(into);
        if (!ec && count > 0) {
            co_return count;
        }
        if (ec && ec != boost::asio::error::operation_aborted) {
            co_return translate(ec);
        }
        const auto cancellation = co_await boost::asio::this_coro::cancellation_state;
        if (cancellation.cancelled() != boost::asio::cancellation_type::none) {
            co_return errc::interrupted;
        }
    }
}

template <Transport T>
boost::asio::awaitable<Result<void>>
TransportLink<T>::write_all(std::span<const std::uint8_t> bytes, Deadline deadline) {
    Operation operation(*this, writing_, deadline);
    while (!bytes.empty()) {
        if (const auto reason = operation.reason_to_stop()) {
            co_return *reason;
        }
        const auto [ec, count] = co_await transport_.write_some(bytes);
        bytes = bytes.subspan(count);
        if (!ec) {
            continue;
        }
        if (ec != boost::asio::error::operation_aborted) {
            co_return translate(ec);
        }
        const auto cancellation = co_await boost::asio::this_coro::cancellation_state;
        if (cancellation.cancelled() != boost::asio::cancellation_type::none) {
            co_return errc::interrupted;
        }
    }
    co_return Result<void>{};
}

template <Transport T>
void TransportLink<T>::flush_input() {
    // Bounded, so that a device faster than we are cannot hold us here.
    constexpr int most_reads = 64;
    std::array<std::uint8_t, 4096> discarded{};
    for (int i = 0; i < most_reads && transport_.is_open(); ++i) {
        if (transport_.read_now(discarded) == 0) {
            return;
        }
    }
}

template <Transport T>
void TransportLink<T>::close() {
    if (!transport_.is_open()) {
        return;
    }
    transport_.close();
    reading_.timer.stop();
    writing_.timer.stop();
}

}  // namespace sweepcast::link
