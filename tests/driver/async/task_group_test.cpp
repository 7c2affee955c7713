// TaskGroup: joining, cancelling, failing.
#include "driver/async/task_group.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>

namespace sweepcast::async {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;

class TaskGroupTest : public testing::Test {
protected:
    /// A coroutine that ends by cancellation only, and says that it was cleaned up.
    static asio::awaitable<void> wait_for_ever(asio::io_context& context, int& cleaned_up) {
        struct Cleanup {
            int& count;
            ~Cleanup() { ++count; }
        } cleanup{cleaned_up};
        asio::steady_timer timer(context, asio::steady_timer::time_point::max());
        co_await timer.async_wait(asio::use_awaitable);
    }

    bool join(std::chrono::milliseconds limit) {
        auto joined = asio::co_spawn(context, group.join(limit), asio::use_future);
        context.restart();
        while (joined.wait_for(0s) != std::future_status::ready) {
            context.run_one();
        }
        return joined.get();
    }

    asio::io_context context;
    int failures{};
    TaskGroup group{context.get_executor(), [this](std::exception_ptr) { ++failures; }};
    int cleaned_up{};
};

TEST_F(TaskGroupTest, JoinsAtOnceWhenEmpty) {
    EXPECT_TRUE(join(10s));
}

TEST_F(TaskGroupTest, CancelEndsEveryTaskAndIsNoFailure) {
    group.spawn(wait_for_ever(context, cleaned_up));
    group.spawn(wait_for_ever(context, cleaned_up));
    context.poll();
    group.cancel();
    EXPECT_TRUE(join(10s));
    EXPECT_EQ(cleaned_up, 2);
    EXPECT_EQ(failures, 0);
    EXPECT_EQ(group.size(), 0U);
}

TEST_F(TaskGroupTest, JoinGivesUpAtItsLimit) {
    group.spawn(wait_for_ever(context, cleaned_up));
    EXPECT_FALSE(join(1ms));
    EXPECT_EQ(group.size(), 1U);
}

TEST_F(TaskGroupTest, ReportsATaskThatThrows) {
    group.spawn([]() -> asio::awaitable<void> {
        throw std::runtime_error("broken");
        co_return;
    }());
    EXPECT_TRUE(join(10s));
    EXPECT_EQ(failures, 1);
}

TEST_F(TaskGroupTest, JoinWaitsForATaskThatIsUnderWay) {
    asio::steady_timer gate(context, asio::steady_timer::time_point::max());
    bool done = false;
    group.spawn([](asio::steady_timer& opens, bool& finished) -> asio::awaitable<void> {
        boost::system::error_code opened;
        co_await opens.async_wait(asio::redirect_error(asio::use_awaitable, opened));
        finished = true;
    }(gate, done));
    asio::post(context, [&gate] { gate.cancel(); });
    EXPECT_TRUE(join(10s));
    EXPECT_TRUE(done);
}

}  // namespace
}  // namespace sweepcast::async
