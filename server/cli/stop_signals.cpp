#include "server/cli/stop_signals.hpp"

#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/co_spawn.hpp>

#include <algorithm>
#include <array>
#include <csignal>
#include <exception>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): sigaction is POSIX, not C++
#include <thread>
#include <utility>

namespace sweepcast::cli {

namespace asio = boost::asio;

namespace {

/// Those that a user or a service manager sends to stop a program.
constexpr std::array command_signals{SIGINT, SIGTERM, SIGQUIT};

/// The others whose default action ends a program, but for real-time signals.
constexpr std::array others{
    SIGHUP,
    SIGUSR1,
    SIGUSR2,
    SIGALRM,
    SIGXCPU,
    SIGVTALRM,
    SIGPROF,
    SIGIO,
    SIGPWR,
    SIGSTKFLT};

/// Whether nobody ignores or handles it, as `nohup` and profilers do.
bool has_default_action(int signal) {
    struct sigaction action {};
    return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_DFL;
}

}  // namespace

void add_stop_signals(asio::signal_set& signals, int other_use) {
    const auto add = [&](int signal) {
        const bool always = signal == SIGINT || signal == SIGTERM;
        if (signal != other_use && (always || has_default_action(signal))) {
            signals.add(signal);
        }
    };
    std::ranges::for_each(command_signals, add);
    std::ranges::for_each(others, add);
    for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) {
        add(signal);
    }
}

void ignore_write_signals() {
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

StopSignals::StopSignals() : signals_(context_) {
    add_stop_signals(signals_);
    wait_for_signal();
}

void StopSignals::wait_for_signal() {
    signals_.async_wait([this](const boost::system::error_code& cancelled, int signal) {
        if (cancelled) {
            return;
        }
        told_ = true;
        if (std::ranges::find(command_signals, signal) == command_signals.end()) {
            wait_for_signal();
            return;
        }
        for (const int command : command_signals) {
            boost::system::error_code not_held;  // it was ignored at the start
            signals_.remove(command, not_held);
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

void StopSignals::finish(const std::function<void()>& work) {
    /// Runs a context on a thread as long as it exists.
    class Runner {
    public:
        explicit Runner(asio::io_context& context)
            : context_(context)
            , thread_([&context] { context.run(); }) {}
        Runner(const Runner&) = delete;
        Runner& operator=(const Runner&) = delete;
        ~Runner() {
            context_.stop();
            thread_.join();
        }

    private:
        asio::io_context& context_;
        std::thread thread_;
    };
    const Runner watch(context_);
    work();
}

}  // namespace sweepcast::cli
