// DeadlineTimer: ends an operation when its deadline passes, at no cost for those that end before.
#pragma once

#include "driver/link/link.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <functional>
#include <memory>

namespace sweepcast::link {

/// One timer for a long row of operations, one at a time. The timer is not set and cancelled for
/// each: while the wait under way ends before the deadline of the operation, it is left alone and
/// set anew when it ends. So a line that delivers a thousand times a second costs one timer event
/// per time-out period, and an expiry can only ever hit the operation whose deadline has passed.
class DeadlineTimer {
public:
    /// `on_expiry` is called on `executor` and may assume that this object is alive.
    DeadlineTimer(const boost::asio::any_io_executor& executor, std::function<void()> on_expiry);
    DeadlineTimer(const DeadlineTimer&) = delete;
    DeadlineTimer& operator=(const DeadlineTimer&) = delete;
    ~DeadlineTimer();

    /// An operation begins.
    void start(Deadline deadline);
    /// The operation has ended.
    void finish();
    /// Whether the deadline of the operation under way has passed and on_expiry was called.
    [[nodiscard]] bool expired() const;
    /// Ends the wait, so that the timer no longer keeps its io_context busy.
    void stop();

private:
    struct State;
    std::shared_ptr<State> state_;  // waits hold it weakly: their handlers may outlive this object
};

}  // namespace sweepcast::link
