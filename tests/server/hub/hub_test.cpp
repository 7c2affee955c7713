// Hub: publishing from one thread, delivering on others.
#include "server/hub/hub.hpp"

#include "driver/async/worker.hpp"
#include "server/frame/message_framing.hpp"
#include "tests/server/hub/socket_pair.hpp"
#include "tests/server/hub/wire_messages.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sweepcast::hub {
namespace {

namespace asio = boost::asio;

void no_failure(std::exception_ptr) {
    FAIL() << "a task failed";
}

class HubTest : public testing::Test {
protected:
    static constexpr std::size_t worker_count = 4;

    HubTest() {
        std::vector<Hub::Executor> executors;
        for (std::size_t i = 0; i < worker_count; ++i) {
            workers.push_back(std::make_unique<async::Worker>("test", no_failure));
            executors.push_back(workers.back()->executor());
        }
        hub = std::make_unique<Hub>(executors);
    }
    ~HubTest() override { workers.clear(); }

    /// The texts of the next messages that arrive.
    static asio::awaitable<std::vector<std::string>>
    read_texts(asio::ip::tcp::socket& client, std::size_t count) {
        frame::DelimitedReader reader(1U << 16U);
        std::vector<std::string> texts;
        std::array<std::uint8_t, 1024> chunk{};
        const auto space = asio::buffer(chunk);
        while (texts.size() < count) {
            const auto got = co_await client.async_read_some(space, asio::use_awaitable);
            reader.push(std::span(chunk).first(got));
            for (auto next = reader.next(); next && *next; next = reader.next()) {
                v1::ServerMessage message;
                message.ParseFromArray((*next)->data(), static_cast<int>((*next)->size()));
                texts.push_back(message.closing().reason());
            }
        }
        co_return texts;
    }

    /// Subscribes on a worker, tells so, and collects `count` messages.
    static asio::awaitable<std::vector<std::string>>
    collect(Hub& hub, std::size_t worker, std::size_t count, std::promise<void>& subscribed) {
        auto [client, gateway] = socket_pair(co_await asio::this_coro::executor);
        Outbox outbox(std::move(gateway), frame::Framing::delimited);
        async::TaskGroup attendants(co_await asio::this_coro::executor, no_failure);
        outbox.set_up({.frames = 1000}, nullptr, [&] { attendants.spawn(outbox.run()); });
        LocalHub::Subscription subscription(hub.local(worker), outbox);
        EXPECT_TRUE(subscription.set_wish(Wish{}));
        subscribed.set_value();
        const auto texts = co_await read_texts(client, count);
        co_await attendants.join(std::chrono::seconds(60));
        co_return texts;
    }

    std::vector<std::unique_ptr<async::Worker>> workers;
    std::unique_ptr<Hub> hub;
};

TEST_F(HubTest, EveryWorkersSubscriberGetsEverySweepInOrder) {
    constexpr std::size_t sweeps = 200;
    std::vector<std::promise<void>> subscribed(worker_count);
    std::vector<std::future<std::vector<std::string>>> collected;
    for (std::size_t i = 0; i < worker_count; ++i) {
        collected.push_back(asio::co_spawn(
            workers[i]->executor(),
            collect(*hub, i, sweeps, subscribed[i]),
            asio::use_future
        ));
    }
    for (auto& promise : subscribed) {
        promise.get_future().wait();
    }
    const auto wanted = hub->variants().wanted(1);
    ASSERT_EQ(wanted.size(), 1U);
    EXPECT_EQ(hub->variants().subscribers(), worker_count);

    std::vector<std::string> expected;
    for (std::size_t i = 0; i < sweeps; ++i) {
        expected.push_back(std::to_string(i));
        SweepNews news;
        news.lidar = 1;
        news.frames.push_back({wanted[0], message(expected.back())});
        hub->publish(std::move(news));
    }
    for (auto& texts : collected) {
        EXPECT_EQ(texts.get(), expected);
    }
}

TEST_F(HubTest, AWorkerThatIsStuckGetsNoMoreThanABoundOfSweeps) {
    std::promise<void> release;
    asio::post(workers[0]->executor(), [&] { release.get_future().wait(); });
    for (int i = 0; i < 1000; ++i) {
        hub->publish(SweepNews{.lidar = 1, .sweep = {}, .frames = {}});
    }
    EXPECT_GT(hub->frames_withheld(), 0U);
    release.set_value();
}

}  // namespace
}  // namespace sweepcast::hub
