// StopSignals: Ctrl-C and the service manager's stop, for as long as a command runs.
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/cancellation_signal.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include <functional>

namespace sweepcast::cli {

/// SIGINT and SIGTERM, held back from the moment it exists, so that none falls between two steps of
/// a start. A second signal finds the default action again and ends the program at once.
class StopSignals {
public:
    StopSignals();

    /// Runs a task on this thread until it ends; cancels it when told to stop.
    /// False if told to stop. Rethrows what the task ended with unless told to stop.
    bool run(boost::asio::awaitable<void> task);

    /// The same for a task that has something to finish: it is not cancelled but asked by `stop`,
    /// and has all the time it needs.
    bool run(boost::asio::awaitable<void> task, const std::function<void()>& stop);

    /// Returns when told to stop.
    void wait();

    /// Where the task runs.
    [[nodiscard]] boost::asio::any_io_executor executor() { return context_.get_executor(); }

private:
    bool run(
        boost::asio::awaitable<void> task,
        boost::asio::cancellation_signal& cancel,
        const std::function<void()>& stop
    );

    boost::asio::io_context context_;
    boost::asio::signal_set signals_;
    bool told_{};
};

}  // namespace sweepcast::cli
