// StopSignals: real signals, to this very process.
#include "server/cli/stop_signals.hpp"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): sigaction is POSIX, not C++
#include <stdexcept>
#include <thread>

namespace sweepcast::cli {
namespace {

namespace asio = boost::asio;

bool has_default_action(int signal) {
    struct sigaction action {};
    return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_DFL;
}

asio::awaitable<void> set(bool& ran) {
    ran = true;
    co_return;
}

/// Waits for ever, and notes how it went.
asio::awaitable<void> hang(bool& begun, bool& finished) {
    begun = true;
    std::raise(SIGINT);
    asio::steady_timer never(
        co_await asio::this_coro::executor,
        asio::steady_timer::duration::max()
    );
    co_await never.async_wait(asio::use_awaitable);
    finished = true;
}

asio::awaitable<void> fail() {
    throw std::runtime_error("broken");
    co_return;
}

TEST(StopSignals, ATaskRunsToItsEnd) {
    StopSignals signals;
    bool ran = false;
    EXPECT_TRUE(signals.run(set(ran)));
    EXPECT_TRUE(ran);
}

TEST(StopSignals, ASignalEndsATaskThatWaits) {
    StopSignals signals;
    bool begun = false;
    bool finished = false;
    EXPECT_FALSE(signals.run(hang(begun, finished)));
    EXPECT_TRUE(begun);
    EXPECT_FALSE(finished);
    signals.wait();  // told already
}

TEST(StopSignals, ATaskThatIsAskedFinishesWhatItHasBegun) {
    StopSignals signals;
    bool begun = false;
    bool finished = false;
    asio::steady_timer until_asked(signals.executor(), asio::steady_timer::duration::max());
    const auto work = [&]() -> asio::awaitable<void> {
        begun = true;
        std::raise(SIGTERM);
        boost::system::error_code asked;
        co_await until_asked.async_wait(asio::redirect_error(asio::use_awaitable, asked));
        asio::steady_timer farewell(signals.executor(), std::chrono::milliseconds(1));
        co_await farewell.async_wait(asio::use_awaitable);
        finished = true;
    };
    EXPECT_FALSE(signals.run(work(), [&until_asked] { until_asked.cancel(); }));
    EXPECT_TRUE(begun);
    EXPECT_TRUE(finished);
}

TEST(StopSignals, ASignalBeforeATaskKeepsItFromStarting) {
    StopSignals signals;
    std::raise(SIGTERM);
    bool ran = false;
    EXPECT_FALSE(signals.run(set(ran)));
    EXPECT_FALSE(ran);
}

TEST(StopSignals, WhatATaskThrowsIsThrownOnAtOnce) {
    StopSignals signals;
    EXPECT_THROW(signals.run(fail()), std::runtime_error);
}

TEST(StopSignals, ASignalBetweenTasksIsNotLost) {
    StopSignals signals;
    bool ran = false;
    ASSERT_TRUE(signals.run(set(ran)));
    std::raise(SIGTERM);
    signals.wait();
}

TEST(StopSignals, ASecondCommandToStopEndsTheProgramAtOnce) {
    StopSignals signals;
    std::raise(SIGINT);
    signals.wait();
    EXPECT_TRUE(has_default_action(SIGINT));
    EXPECT_TRUE(has_default_action(SIGTERM));
    EXPECT_TRUE(has_default_action(SIGQUIT));
}

TEST(StopSignals, ATerminationAfterAHangUpDoesNotEndTheProgramButASecondOneDoes) {
    std::signal(SIGHUP, SIG_DFL);  // a test under nohup ignores it
    StopSignals signals;
    std::raise(SIGHUP);
    signals.wait();
    ASSERT_FALSE(has_default_action(SIGTERM));
    std::raise(SIGTERM);
    bool ran = false;
    EXPECT_FALSE(signals.run(set(ran)));
    EXPECT_TRUE(has_default_action(SIGTERM));
}

TEST(StopSignals, SignalsAreHandledWhileTheProgramFinishes) {
    std::signal(SIGHUP, SIG_DFL);
    StopSignals signals;
    std::raise(SIGHUP);
    signals.wait();
    signals.finish([] {
        std::raise(SIGTERM);
        while (!has_default_action(SIGTERM)) {
            std::this_thread::yield();
        }
    });
}

}  // namespace
}  // namespace sweepcast::cli
