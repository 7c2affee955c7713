// LinkFixture: drives a link step by step against its peer.
#pragma once

#include "driver/link/link.hpp"

#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/cancellation_signal.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <exception>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

namespace sweepcast::link {

using Bytes = std::vector<std::uint8_t>;

inline Deadline in(std::chrono::milliseconds delay) {
    return std::chrono::steady_clock::now() + delay;
}

/// A read or write that was started; its result once it has ended.
template <class T>
struct Pending {
    std::optional<Result<T>> result;
    boost::asio::cancellation_signal cancel;
};

template <class Peer>
class LinkFixture : public testing::Test {
public:
    static constexpr std::chrono::seconds long_enough{10};

    /// Starts an operation; it is pending, or has ended, when this returns.
    template <class T>
    void start(Pending<T>& operation, boost::asio::awaitable<Result<T>> work) {
        spawn(operation, std::move(work));
        context_.restart();
        context_.poll();
    }

    void start_read(Pending<std::size_t>& read, std::span<std::uint8_t> into, Deadline deadline) {
        start(read, link_->read_some(into, deadline));
    }

    template <class T>
    void spawn(Pending<T>& operation, boost::asio::awaitable<Result<T>> work) {
        boost::asio::co_spawn(
            context_,
            std::move(work),
            boost::asio::bind_cancellation_slot(
                operation.cancel.slot(),
                [&operation](const std::exception_ptr& failure, Result<T> result) {
                    if (!failure) {
                        operation.result = result;
                    }
                }
            )
        );
    }

    /// Waits until it has ended, at most ten seconds.
    template <class T>
    Result<T> finish(Pending<T>& operation) {
        context_.restart();
        while (!operation.result && context_.run_one_for(long_enough) != 0) {
        }
        return operation.result.value();
    }

    Result<std::size_t> read(std::span<std::uint8_t> into, Deadline deadline) {
        Pending<std::size_t> operation;
        start_read(operation, into, deadline);
        return finish(operation);
    }

    Result<void> write(std::span<const std::uint8_t> bytes, Deadline deadline) {
        Pending<void> operation;
        start(operation, link_->write_all(bytes, deadline));
        return finish(operation);
    }

    /// Reads until `count` bytes are there.
    Bytes read_exactly(std::size_t count) {
        Bytes bytes(count);
        std::size_t have = 0;
        while (have < count) {
            have += read(std::span(bytes).subspan(have), in(long_enough)).value();
        }
        return bytes;
    }

    /// Has the peer read `count` bytes while the link goes on writing.
    std::size_t drain(std::size_t count) {
        std::size_t received = 0;
        const Deadline give_up = in(long_enough);
        while (received < count && std::chrono::steady_clock::now() < give_up) {
            received += peer_.receive(count).size();
            context_.restart();
            context_.poll();
        }
        return received;
    }

    static Bytes every_byte() {
        Bytes bytes(256);
        std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
        return bytes;
    }

    boost::asio::io_context context_;
    Peer peer_;
    std::unique_ptr<Link> link_ = peer_.make_link(context_);
    std::array<std::uint8_t, 64> buffer_{};
};

}  // namespace sweepcast::link
