// StopSignals: Ctrl-C, the service manager's stop and every other signal that would end the
// program, for as long as a command runs.
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/cancellation_signal.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include <functional>

namespace sweepcast::cli {

/// Adds every signal whose default action would end the program at once and leave a lidar's motor
/// on, except `other_use`. A signal that is ignored (by `nohup`, for example) or handled already is
/// left alone; SIGINT and SIGTERM are added in any case.
/// Not among them: signals of faults in the program itself, such as SIGSEGV, and those that cannot
/// be handled.
void add_stop_signals(boost::asio::signal_set& signals, int other_use = 0);

/// Makes a failed write return an error instead of ending the program: SIGPIPE (the reader is gone)
/// and SIGXFSZ (the file is too large).
void ignore_write_signals();

/// Catches the signals of add_stop_signals() from the moment it exists, so that no signal is lost
/// between two steps of a start. The first signal stops the program in an orderly way. While the
/// program stops:
///
/// | the signal                            | does                                    |
/// | ------------------------------------- | --------------------------------------- |
/// | SIGINT, SIGTERM or SIGQUIT, the first | nothing if another signal came first    |
/// | SIGINT, SIGTERM or SIGQUIT, the next  | ends the program at once                |
/// | any other                             | nothing                                 |
///
/// A terminal that closes sends SIGHUP more than once, and the session manager then sends SIGTERM.
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

    /// Runs `work`, the end of the program after wait(), and handles signals meanwhile.
    void finish(const std::function<void()>& work);

    /// Where the task runs.
    [[nodiscard]] boost::asio::any_io_executor executor() { return context_.get_executor(); }

private:
    bool run(
        boost::asio::awaitable<void> task,
        boost::asio::cancellation_signal& cancel,
        const std::function<void()>& stop
    );
    void wait_for_signal();

    boost::asio::io_context context_;
    boost::asio::signal_set signals_;
    bool told_{};
};

}  // namespace sweepcast::cli
