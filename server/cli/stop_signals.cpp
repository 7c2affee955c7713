#include "server/cli/stop_signals.hpp"

#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/co_spawn.hpp>

#include <csignal>
#include <exception>
#include <utility>

namespace sweepcast::cli {

namespace asio = boost::asio;

StopSignals::StopSignals() : signals_(context_, SIGINT, SIGTERM) {
    signals_.async_wait([this](const boost::system::error_code& cancelled, int) {
        if (!cancelled) {
            told_ = true;
            signals_.clear();
        }
    });
}

bool StopSignals::run(asio::awaitable<void> task) {
    asio::cancellation_signal cancel;
    return run(std::move(task), cancel, [&cancel] {
        cancel.emit(asio::cancellation_type::terminal);
    });
}

bool StopSignals::run(asio::awaitable<void> task, const std::function<void()>& stop) {
    asio::cancellation_signal unused;
    return run(std::move(task), unused, stop);
}

bool StopSignals::run(
    asio::awaitable<void> task,
    asio::cancellation_signal& cancel,
    const std::function<void()>& stop
) {
    context_.poll();  // a signal may have come since the last step
    if (told_) {
        return false;
    }
    bool ended = false;
    std::exception_ptr failure;
    asio::co_spawn(
        context_,
        std::move(task),
        asio::bind_cancellation_slot(
            cancel.slot(),
            [&ended, &failure](std::exception_ptr thrown) {
                ended = true;
                failure = std::move(thrown);
            }
        )
    );
    while (!ended && !told_) {
        context_.run_one();
    }
    if (told_ && !ended) {
        stop();
    }
    while (!ended) {
        context_.run_one();
    }
    if (told_) {
        return false;
    }
    if (failure) {
        std::rethrow_exception(failure);
    }
    return true;
}

void StopSignals::wait() {
    while (!told_) {
        context_.run_one();
    }
}

}  // namespace sweepcast::cli
