#include "tests/bench/bare_websockets.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket.hpp>
#include <spdlog/logger.h>

#include <exception>
#include <stdexcept>
#include <utility>

namespace sweepcast::bench {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;

namespace {

constexpr std::size_t most_connections = 20'000;

/// Serves one client until it leaves.
asio::awaitable<void> serve(tcp::socket socket, frame::WireMessagePtr message) {
    beast::websocket::stream<beast::tcp_stream> ws(std::move(socket));
    ws.set_option(beast::websocket::stream_base::timeout::suggested(beast::role_type::server));
    ws.auto_fragment(false);
    ws.binary(true);
    const auto [refused] = co_await ws.async_accept(asio::as_tuple(asio::use_awaitable));
    if (refused) {
        co_return;
    }
    const auto bytes = message->message();
    const auto [unsent, sent] = co_await ws.async_write(
        asio::buffer(bytes.data(), bytes.size()),
        asio::as_tuple(asio::use_awaitable)
    );
    beast::flat_buffer buffer;
    for (bool open = !unsent; open;) {
        const auto [ended, got] =
            co_await ws.async_read(buffer, asio::as_tuple(asio::use_awaitable));
        buffer.clear();
        open = !ended;
    }
}

}  // namespace

BareWebsockets::BareWebsockets(frame::WireMessagePtr message) {
    workers_.push_back(std::make_unique<async::Worker>("bare", [](std::exception_ptr failure) {
        std::rethrow_exception(std::move(failure));
    }));
    auto opened = net::Listener::open(
        tcp::endpoint(asio::ip::address_v4::loopback(), 0),
        workers_,
        most_connections,
        [message = std::move(message)](tcp::socket socket, std::size_t) {
            return serve(std::move(socket), message);
        },
        std::make_shared<spdlog::logger>("bare")  // writes nowhere
    );
    if (!opened) {
        throw std::runtime_error(opened.error().cause);
    }
    listener_ = std::move(*opened);
    listener_->start();
}

BareWebsockets::~BareWebsockets() {
    listener_->close();
    workers_.front()->stop();
    listener_.reset();
}

}  // namespace sweepcast::bench
