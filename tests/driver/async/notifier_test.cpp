// Notifier: waking, deadlines, leaving.
#include "driver/async/notifier.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

#include <chrono>

namespace sweepcast::async {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

TEST(Notifier, WakesEveryWaiter) {
    asio::io_context context;
    Notifier notifier(context.get_executor());
    auto first =
        asio::co_spawn(context, notifier.wait_until(Clock::time_point::max()), asio::use_future);
    auto second = asio::co_spawn(context, notifier.wait_until(Clock::now() + 1h), asio::use_future);
    context.poll();
    notifier.notify();
    context.run();
    EXPECT_TRUE(first.get());
    EXPECT_TRUE(second.get());
}

TEST(Notifier, SaysWhenTheDeadlinePassedFirst) {
    asio::io_context context;
    Notifier notifier(context.get_executor());
    auto waited = asio::co_spawn(context, notifier.wait_until(Clock::now()), asio::use_future);
    context.run();
    EXPECT_FALSE(waited.get());
}

TEST(Notifier, ForgetsWhoHasLeft) {
    asio::io_context context;
    Notifier notifier(context.get_executor());
    auto waited = asio::co_spawn(context, notifier.wait_until(Clock::now()), asio::use_future);
    context.run();
    notifier.notify(
    );  // touches a destroyed timer if the waiter was kept: the sanitizers would tell
    EXPECT_FALSE(waited.get());
}

}  // namespace
}  // namespace sweepcast::async
