// Calls that block, on threads of their own: lanes, deadlines, and those given up.
#include "driver/async/blocking.hpp"

#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/cancellation_signal.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/system/system_error.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace sweepcast::async {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;

/// A call that hangs until it is let go.
class Hang {
public:
    ~Hang() { let_go(); }
    std::function<void()> call() {
        return [this, released = released_.get_future().share()] {
            begun_.set_value();
            released.wait();
        };
    }
    void wait_until_begun() { begun_.get_future().wait(); }
    void let_go() {
        if (!std::exchange(let_go_, true)) {
            released_.set_value();
        }
    }

private:
    std::promise<void> begun_;
    std::promise<void> released_;
    bool let_go_{};
};

class RunBlocking : public testing::Test {
protected:
    using Made = std::optional<int>;

    std::future<Made>
    start(const std::string& lane, std::chrono::milliseconds limit, std::function<int()> call) {
        return asio::co_spawn(
            context_,
            run_blocking<int>(lane, std::chrono::steady_clock::now() + limit, std::move(call)),
            asio::bind_cancellation_slot(cancel_.slot(), asio::use_future)
        );
    }

    Made run(const std::string& lane, std::chrono::milliseconds limit, std::function<int()> call) {
        auto made = start(lane, limit, std::move(call));
        context_.restart();
        context_.run_for(60s);
        return made.get();
    }

    asio::io_context context_;
    asio::cancellation_signal cancel_;
};

TEST_F(RunBlocking, MakesTheCallOnAnotherThread) {
    std::thread::id where;
    EXPECT_EQ(
        run("a",
            10s,
            [&] {
                where = std::this_thread::get_id();
                return 7;
            }),
        7
    );
    EXPECT_NE(where, std::this_thread::get_id());
}

TEST_F(RunBlocking, ThrowsWhatTheCallThrows) {
    const auto call = [this] {
        return run("a", 10s, []() -> int { throw std::runtime_error("broken"); });
    };
    EXPECT_THROW(call(), std::runtime_error);
}

TEST_F(RunBlocking, GivesUpACallThatHangsWhileOtherLanesGoOn) {
    Hang hang;
    start_blocking("a", hang.call());
    hang.wait_until_begun();
    EXPECT_EQ(run("a", 20ms, [] { return 1; }), std::nullopt);
    EXPECT_EQ(run("b", 10s, [] { return 2; }), 2);
}

TEST_F(RunBlocking, DoesNotMakeACallThatWasGivenUpBeforeItsTurn) {
    Hang hang;
    start_blocking("a", hang.call());
    hang.wait_until_begun();
    std::atomic<int> made = 0;
    EXPECT_EQ(run("a", 20ms, [&] { return ++made; }), std::nullopt);
    hang.let_go();
    EXPECT_EQ(run("a", 10s, [] { return 3; }), 3);
    EXPECT_EQ(made, 0);
}

TEST_F(RunBlocking, CallsThatWereGivenUpDoNotPileUpBehindOneThatHangs) {
    Hang hang;
    start_blocking("a", hang.call());
    hang.wait_until_begun();
    const auto held = std::make_shared<int>(1);
    for (int i = 0; i < 100; ++i) {
        EXPECT_EQ(run("a", 0ms, [held] { return *held; }), std::nullopt);
    }
    EXPECT_LT(held.use_count(), 10);
}

TEST_F(RunBlocking, MakesTheCallsOfALaneInTheirOrder) {
    std::vector<int> order;
    for (int i = 0; i < 100; ++i) {
        start_blocking("a", [&order, i] { order.push_back(i); });
    }
    run("a", 10s, [&order] {
        order.push_back(100);
        return 0;
    });
    EXPECT_EQ(order.size(), 101U);
    EXPECT_TRUE(std::ranges::is_sorted(order));
}

TEST_F(RunBlocking, DestroysWhatACallGivesThatNobodyWaitsForAnyMore) {
    struct Destroyed {
        std::promise<std::thread::id> where;
        ~Destroyed() { where.set_value(std::this_thread::get_id()); }
    };
    Hang hang;
    auto given = std::make_shared<Destroyed>();
    auto where = given->where.get_future();
    std::function<std::shared_ptr<Destroyed>()> call = [&given, wait = hang.call()] {
        wait();
        return std::move(given);
    };
    auto made = asio::co_spawn(
        context_,
        run_blocking<std::shared_ptr<Destroyed>>(
            "a",
            std::chrono::steady_clock::now() + 20ms,
            std::move(call)
        ),
        asio::use_future
    );
    context_.run();
    EXPECT_EQ(made.get(), std::nullopt);
    hang.let_go();
    EXPECT_NE(where.get(), std::this_thread::get_id());
}

TEST_F(RunBlocking, EndsAtOnceWhenCancelled) {
    Hang hang;
    start_blocking("a", hang.call());
    hang.wait_until_begun();
    auto made = start("a", 1h, [] { return 1; });
    context_.restart();
    context_.poll();
    cancel_.emit(asio::cancellation_type::terminal);
    context_.run_for(60s);
    ASSERT_EQ(made.wait_for(0s), std::future_status::ready);
    EXPECT_THROW(made.get(), boost::system::system_error);
}

}  // namespace
}  // namespace sweepcast::async
