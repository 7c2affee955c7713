// probe(): a lidar that is met is left in peace.
#include "driver/device/probe.hpp"

#include "driver/protocol/request.hpp"
#include "tests/driver/device/fake_scanner.hpp"
#include "tests/driver/device/memory_link.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/asio/write.hpp>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <string>
#include <vector>

namespace sweepcast::device {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace std::chrono_literals;

constexpr auto patience = 60s;

/// A scanner behind a serial bridge.
class ProbeTest : public testing::Test {
protected:
    ProbeTest() { line.baud = 0; }

    /// Lets one host in and the scanner answer it, until it leaves.
    asio::awaitable<void> serve() {
        constexpr auto as_tuple = asio::as_tuple(asio::use_awaitable);
        auto socket = co_await acceptor.async_accept(asio::use_awaitable);
        std::array<std::uint8_t, 1024> bytes{};
        for (;;) {
            const auto [gone, count] =
                co_await socket.async_read_some(asio::buffer(bytes), as_tuple);
            if (gone) {
                co_return;
            }
            line.on_write(std::span(bytes).first(count));
            const std::vector<std::uint8_t> answer(line.to_host.begin(), line.to_host.end());
            line.to_host.clear();
            co_await asio::async_write(socket, asio::buffer(answer), as_tuple);
        }
    }

    asio::io_context context;
    tcp::acceptor acceptor{context, {asio::ip::address_v4::loopback(), 0}};
    Line line{context.get_executor()};
    FakeScanner scanner{line};
};

TEST_F(ProbeTest, EndsTheScanAndStopsTheMotorOfALidarThatWasLeftRunning) {
    scanner.info.model = 0x61;  // its motor turns until it is told 0 rpm
    auto served = asio::co_spawn(context, serve(), asio::use_future);
    const auto port = acceptor.local_endpoint().port();
    link::LinkUrl url{"here", link::TcpPlace{"127.0.0.1", port}};
    auto answer = asio::co_spawn(
        context,
        probe(context.get_executor(), std::move(url), {}),
        asio::use_future
    );
    context.run_for(patience);
    ASSERT_TRUE(context.stopped()) << "it takes too long";
    served.get();
    const auto probed = answer.get();
    ASSERT_TRUE(probed) << probed.error().cause;
    EXPECT_EQ(probed->identity.info, scanner.info);
    EXPECT_EQ(scanner.requests.front().command, protocol::Command::stop);
    EXPECT_EQ(scanner.requests.back(), protocol::motor_rpm_request(0));
}

}  // namespace
}  // namespace sweepcast::device
