#include "server/client/stream_client.hpp"

#include "server/client/connections.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <utility>
#include <variant>

namespace sweepcast::client {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

using Connected = Result<std::unique_ptr<StreamClient>>;

/// A gateway may be silent for as long as its lidars are; that it is gone without a word (power,
/// cable) shows by its not answering the system's own probes, within half a minute.
void notice_dead_peer(tcp::socket& socket) {
    const int handle = socket.native_handle();
    const auto set = [handle](int level, int option, int value) {
        (void)setsockopt(handle, level, option, &value, sizeof value);  // then it shows later
    };
    set(SOL_SOCKET, SO_KEEPALIVE, 1);
    set(IPPROTO_TCP, TCP_KEEPIDLE, 10);
    set(IPPROTO_TCP, TCP_KEEPINTVL, 5);
    set(IPPROTO_TCP, TCP_KEEPCNT, 4);
    set(IPPROTO_TCP, TCP_USER_TIMEOUT, 30'000);
}

asio::awaitable<Connected> open(StreamUrl url) {
    const auto executor = co_await asio::this_coro::executor;
    tcp::resolver resolver(executor);
    const auto [not_found, endpoints] =
        co_await resolver.async_resolve(url.host, url.port, asio::as_tuple(asio::use_awaitable));
    if (not_found) {
        co_return not_found;
    }
    tcp::socket socket(executor);
    const auto [refused, endpoint] =
        co_await asio::async_connect(socket, endpoints, asio::as_tuple(asio::use_awaitable));
    if (refused) {
        co_return refused;
    }
    notice_dead_peer(socket);
    if (url.websocket) {
        co_return co_await make_ws_client(std::move(socket), std::move(url));
    }
    co_return make_tcp_client(std::move(socket));
}

Problem describe(const error_code& failed, const StreamUrl& url) {
    auto hint = fmt::format(
        "is the gateway running there? try: curl http://{}:8080/healthz",
        url.url_host()
    );
    if (url.websocket) {
        hint = "check host, port, path and query; the path is /api/v1/stream";
    }
    return {
        failed,
        fmt::format("cannot connect to {}:{}: {}", url.url_host(), url.port, failed.message()),
        hint};
}

}  // namespace

asio::awaitable<Result<std::unique_ptr<StreamClient>, Problem>>
StreamClient::connect(StreamUrl url, std::chrono::milliseconds limit) {
    using namespace asio::experimental::awaitable_operators;
    asio::steady_timer deadline(co_await asio::this_coro::executor, limit);
    auto outcome = co_await (open(url) || deadline.async_wait(asio::as_tuple(asio::use_awaitable)));
    if (outcome.index() != 0) {
        co_return describe(asio::error::timed_out, url);
    }
    auto connected = std::get<0>(std::move(outcome));
    if (!connected) {
        co_return describe(connected.error(), url);
    }
    co_return std::move(*connected);
}

asio::awaitable<Result<void>> StreamClient::subscribe(const v1::Subscribe& wish) {
    v1::ClientMessage message;
    *message.mutable_subscribe() = wish;
    co_return co_await send(message.SerializeAsString());
}

asio::awaitable<Result<void>> StreamClient::unsubscribe() {
    v1::ClientMessage message;
    message.mutable_unsubscribe();
    co_return co_await send(message.SerializeAsString());
}

asio::awaitable<Result<const v1::ServerMessage*>> StreamClient::receive() {
    const auto bytes = co_await receive_bytes();
    if (!bytes) {
        co_return bytes.error();
    }
    if (!message_.ParseFromArray(bytes->data(), static_cast<int>(bytes->size()))) {
        co_return make_error_code(boost::system::errc::bad_message);
    }
    co_return &message_;
}

}  // namespace sweepcast::client
