// run_blocking: makes a call that may block on another thread, and waits for it with a deadline.
#pragma once

#include "driver/async/notifier.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/this_coro.hpp>

#include <chrono>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace sweepcast::async {

namespace detail {

/// A call in a lane, for which a coroutine waits until it gives it up.
class BlockingCall : public std::enable_shared_from_this<BlockingCall> {
public:
    explicit BlockingCall(const boost::asio::any_io_executor& executor)
        : executor_(executor)
        , changed_(executor) {}
    BlockingCall(const BlockingCall&) = delete;
    BlockingCall& operator=(const BlockingCall&) = delete;
    virtual ~BlockingCall() = default;

    /// On the lane's thread: makes the call, unless nobody waits for it any more.
    void run();

    /// Waits until the call has returned. False if the deadline passed first.
    boost::asio::awaitable<bool> wait_until(std::chrono::steady_clock::time_point deadline);
    /// Nobody waits any more: what the call gives is destroyed on the lane's thread.
    void abandon();
    [[nodiscard]] bool abandoned() const;

    std::exception_ptr failure;

private:
    virtual void make() = 0;
    virtual void drop() = 0;

    boost::asio::any_io_executor executor_;
    mutable std::mutex mutex_;
    bool abandoned_{};  ///< under mutex_: as long as it is not set, the executor's context is there
    bool ended_{};      ///< on the executor
    Notifier changed_;
};

template <class T>
class BlockingCallOf final : public BlockingCall {
public:
    BlockingCallOf(const boost::asio::any_io_executor& executor, std::function<T()> call)
        : BlockingCall(executor)
        , call_(std::move(call)) {}

    std::optional<T> result;

private:
    void make() override { result.emplace(call_()); }
    void drop() override { result.reset(); }

    std::function<T()> call_;
};

void enter_lane(const std::string& lane, std::shared_ptr<BlockingCall> call);

}  // namespace detail

/// Makes `call` on another thread and gives what it returns; nothing if that takes longer than
/// until `deadline`. The calls of one lane are made one after the other, on a thread that is there
/// while there are any; lanes never wait for one another. So a call that hangs, as some drivers
/// have it, holds up its own lane alone. `call` must not refer to what may be gone by the time it
/// is made: given up, or cancelled, it may still be under way.
/// Throws what `call` throws, or boost::system::system_error (operation_aborted) if the coroutine
/// is cancelled meanwhile.
template <class T>
boost::asio::awaitable<std::optional<T>> run_blocking(
    std::string lane,
    std::chrono::steady_clock::time_point deadline,
    std::function<T()> call
) {
    const auto executor = co_await boost::asio::this_coro::executor;
    const auto made = std::make_shared<detail::BlockingCallOf<T>>(executor, std::move(call));
    struct Abandon {
        detail::BlockingCall& call;
        ~Abandon() { call.abandon(); }
    } abandon{*made};
    detail::enter_lane(lane, made);
    const bool ended = co_await made->wait_until(deadline);
    if (!ended) {
        co_return std::nullopt;
    }
    if (made->failure) {
        std::rethrow_exception(made->failure);
    }
    co_return std::move(made->result);
}

/// Makes `call` in its turn in the lane; nobody waits for it. It must not throw.
void start_blocking(const std::string& lane, std::function<void()> call);

}  // namespace sweepcast::async
