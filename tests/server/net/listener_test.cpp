// Listener: real sockets on loopback.
#include "server/net/listener.hpp"

#include "server/net/endpoint.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <list>
#include <memory>
#include <set>
#include <sstream>
#include <string>

namespace sweepcast::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using testing::HasSubstr;

const tcp::endpoint any_port(asio::ip::address_v4::loopback(), 0);

class ListenerTest : public testing::Test {
protected:
    ListenerTest() {
        for (int i = 0; i < 3; ++i) {
            workers.push_back(std::make_unique<async::Worker>("test", [](std::exception_ptr) {
                FAIL();
            }));
        }
    }
    ~ListenerTest() override { stop(); }

    void stop() {
        if (listener) {
            listener->close();
        }
        for (auto& worker : workers) {
            worker->stop();
        }
    }

    Listener& listen(std::size_t max_connections = 100) {
        auto opened = Listener::open(
            any_port,
            workers,
            max_connections,
            [](tcp::socket socket, std::size_t worker) -> asio::awaitable<void> {
                const char name = static_cast<char>('0' + worker);
                co_await asio::async_write(socket, asio::buffer(&name, 1), asio::use_awaitable);
                char last = 0;  // stays until the client goes
                boost::system::error_code gone;
                co_await socket.async_read_some(
                    asio::buffer(&last, 1),
                    asio::redirect_error(asio::use_awaitable, gone)
                );
            },
            std::make_shared<spdlog::logger>("test", sink)
        );
        listener = std::move(*opened);
        listener->start();
        return *listener;
    }

    /// Connects and returns the worker that serves it, or '-' if the connection ends at once.
    char connect() {
        auto& socket = clients.emplace_back(context);
        socket.connect(listener->endpoint());
        char name = '-';
        boost::system::error_code ended;
        asio::read(socket, asio::buffer(&name, 1), ended);
        return name;
    }

    std::ostringstream log;  ///< to be read once the workers have stopped
    std::shared_ptr<spdlog::sinks::ostream_sink_mt> sink =
        std::make_shared<spdlog::sinks::ostream_sink_mt>(log);
    Workers workers;
    std::unique_ptr<Listener> listener;
    asio::io_context context;
    std::list<tcp::socket> clients;
};

TEST_F(ListenerTest, SpreadsConnectionsOverTheWorkers) {
    listen();
    const std::set<char> served_by{connect(), connect(), connect()};
    EXPECT_EQ(served_by, (std::set<char>{'0', '1', '2'}));
}

TEST_F(ListenerTest, RefusesMoreConnectionsThanAllowed) {
    listen(1);
    EXPECT_EQ(connect(), '0');
    EXPECT_EQ(connect(), '-');
}

TEST_F(ListenerTest, ARushOfRefusedConnectionsIsFewLines) {
    listen(1);
    connect();
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 50; ++i) {
        EXPECT_EQ(connect(), '-');
    }
    const auto seconds =
        std::chrono::floor<std::chrono::seconds>(std::chrono::steady_clock::now() - begin);
    stop();
    const auto lines = std::ranges::count(log.str(), '\n');
    EXPECT_GE(lines, 1);
    EXPECT_LE(lines, 2 + seconds.count());
    EXPECT_THAT(log.str(), HasSubstr("connections refused: 1;"));
}

TEST_F(ListenerTest, SaysThatAPortIsInUse) {
    listen();
    const auto second = Listener::open(
        listener->endpoint(),
        workers,
        1,
        {},
        std::make_shared<spdlog::logger>("test")
    );
    ASSERT_FALSE(second);
    EXPECT_THAT(second.error().cause, HasSubstr(to_text(listener->endpoint())));
    EXPECT_THAT(second.error().hint, HasSubstr("another port"));
}

}  // namespace
}  // namespace sweepcast::net
