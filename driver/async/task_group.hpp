// TaskGroup: the owner of coroutines. Nothing is spawned without one, and nothing outlives it
// unseen.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/cancellation_signal.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <exception>
#include <functional>
#include <list>

namespace sweepcast::async {

/// Whether it says that a coroutine was cancelled: what its owner did, not a failure.
[[nodiscard]] bool is_cancellation(const std::exception_ptr& failure);

/// Owns coroutines that run on one executor, all touched from that executor's thread only.
class TaskGroup {
public:
    /// Called when a coroutine ends by an exception other than cancellation.
    using OnFailure = std::function<void(std::exception_ptr)>;

    TaskGroup(boost::asio::any_io_executor executor, OnFailure on_failure);
    TaskGroup(const TaskGroup&) = delete;
    TaskGroup& operator=(const TaskGroup&) = delete;

    /// Starts `task` on the group's executor.
    void spawn(boost::asio::awaitable<void> task);

    /// Cancels every running coroutine (terminal cancellation). Those spawned later are not
    /// affected.
    void cancel();

    /// Waits until no coroutine is left, at most `limit`. Returns true if none is left.
    boost::asio::awaitable<bool> join(std::chrono::steady_clock::duration limit);

    [[nodiscard]] std::size_t size() const { return running_.size(); }

private:
    boost::asio::any_io_executor executor_;
    OnFailure on_failure_;
    std::list<boost::asio::cancellation_signal> running_;
    boost::asio::steady_timer emptied_;
};

}  // namespace sweepcast::async
