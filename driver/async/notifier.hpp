// Notifier: lets coroutines of one thread wait until something changed, with a deadline.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <list>

namespace sweepcast::async {

/// Wakes every waiting coroutine at once. Used on one executor only. The waiter re-checks its own
/// condition: a wake-up says that something may have changed, not what.
class Notifier {
public:
    explicit Notifier(boost::asio::any_io_executor executor) : executor_(std::move(executor)) {}
    Notifier(const Notifier&) = delete;
    Notifier& operator=(const Notifier&) = delete;

    /// Ends every wait that is under way.
    void notify();

    /// Waits for the next notify(). Returns false if `deadline` passed first.
    boost::asio::awaitable<bool> wait_until(std::chrono::steady_clock::time_point deadline);

private:
    boost::asio::any_io_executor executor_;
    std::list<boost::asio::steady_timer*> waiting_;
};

}  // namespace sweepcast::async
