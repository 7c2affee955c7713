// Worker and run_on: which thread runs what, and the end.
#include "driver/async/worker.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

#include <future>
#include <thread>

namespace sweepcast::async {
namespace {

namespace asio = boost::asio;

void no_failure(std::exception_ptr) {
    FAIL() << "a task failed";
}

asio::awaitable<std::thread::id> where_am_i() {
    co_return std::this_thread::get_id();
}

TEST(Worker, RunsItsTasksOnItsThread) {
    Worker worker("test", no_failure);
    std::promise<std::thread::id> ran_on;
    asio::post(worker.executor(), [&] {
        worker.tasks().spawn([](std::promise<std::thread::id>& told) -> asio::awaitable<void> {
            told.set_value(co_await where_am_i());
        }(ran_on));
    });
    EXPECT_NE(ran_on.get_future().get(), std::this_thread::get_id());
}

TEST(RunOn, RunsElsewhereAndComesBack) {
    Worker here("here", no_failure);
    Worker there("there", no_failure);
    struct Threads {
        std::thread::id before, elsewhere, after;
    };
    auto went = asio::co_spawn(
        here.executor(),
        [](Worker& other) -> asio::awaitable<Threads> {
            Threads threads;
            threads.before = std::this_thread::get_id();
            threads.elsewhere = co_await run_on(other.executor(), where_am_i());
            threads.after = std::this_thread::get_id();
            co_return threads;
        }(there),
        asio::use_future
    );
    const auto threads = went.get();
    EXPECT_EQ(threads.before, threads.after);
    EXPECT_NE(threads.before, threads.elsewhere);
}

TEST(Worker, DestroysWhatIsStillSuspendedWhenItEnds) {
    int cleaned_up = 0;
    {
        Worker worker("test", no_failure);
        std::promise<void> suspended;
        asio::post(worker.executor(), [&] {
            worker.tasks().spawn([](int& count) -> asio::awaitable<void> {
                struct Cleanup {
                    int& count;
                    ~Cleanup() { ++count; }
                } cleanup{count};
                asio::steady_timer timer(
                    co_await asio::this_coro::executor,
                    asio::steady_timer::time_point::max()
                );
                co_await timer.async_wait(asio::use_awaitable);
            }(cleaned_up));
            suspended.set_value();
        });
        suspended.get_future().wait();
    }
    EXPECT_EQ(cleaned_up, 1);
}

}  // namespace
}  // namespace sweepcast::async
