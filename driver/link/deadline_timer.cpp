// The one wait behind all deadlines of a DeadlineTimer.
#include "driver/link/deadline_timer.hpp"

#include <boost/asio/steady_timer.hpp>

#include <utility>

namespace sweepcast::link {

namespace {
constexpr Deadline never = Deadline::max();
}

struct DeadlineTimer::State : std::enable_shared_from_this<State> {
    State(const boost::asio::any_io_executor& executor, std::function<void()> callback)
        : timer(executor)
        , on_expiry(std::move(callback)) {}

    void wait_until(Deadline when) {
        armed_for = when;
        timer.expires_at(when);  // ends the wait under way, if there is one
        timer.async_wait([weak = weak_from_this(), when](const error_code& ended_early) {
            if (ended_early) {
                return;
            }
            if (const auto self = weak.lock()) {
                self->on_wait_over(when);
            }
        });
    }

    void on_wait_over(Deadline when) {
        if (when != armed_for) {
            return;  // was already on its way here when the timer was set to another time
        }
        armed_for = never;
        if (deadline == never) {
            return;  // the operation ended long ago and no other began
        }
        if (deadline > std::chrono::steady_clock::now()) {
            wait_until(deadline);
            return;
        }
        expired = true;
        on_expiry();
    }

    boost::asio::steady_timer timer;
    std::function<void()> on_expiry;
    Deadline deadline{never};   // of the operation under way
    Deadline armed_for{never};  // the end of the wait under way; never: there is none
    bool expired{};
};

DeadlineTimer::DeadlineTimer(
    const boost::asio::any_io_executor& executor,
    std::function<void()> on_expiry
)
    : state_(std::make_shared<State>(executor, std::move(on_expiry))) {}

DeadlineTimer::~DeadlineTimer() = default;

void DeadlineTimer::start(Deadline deadline) {
    state_->expired = false;
    state_->deadline = deadline;
    if (deadline < state_->armed_for) {
        state_->wait_until(deadline);
    }
}

void DeadlineTimer::finish() {
    state_->deadline = never;
}

bool DeadlineTimer::expired() const {
    return state_->expired;
}

void DeadlineTimer::stop() {
    state_->armed_for = never;
    state_->timer.cancel();
}

}  // namespace sweepcast::link
