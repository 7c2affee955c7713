// A stream over WebSocket: each message is one binary message.
#include "server/client/connections.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket.hpp>

#include <utility>

namespace sweepcast::client {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

namespace {

class WsClient final : public StreamClient {
public:
    explicit WsClient(asio::ip::tcp::socket socket) : ws_(std::move(socket)) {
        ws_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::client));
        ws_.read_message_max(longest_server_message);
        ws_.binary(true);
    }

    asio::awaitable<Result<void>> shake_hands(const StreamUrl& url) {
        const auto host = url.url_host() + ":" + url.port;
        const auto [failed] =
            co_await ws_.async_handshake(host, url.target, asio::as_tuple(asio::use_awaitable));
        co_return failed ? Result<void>(failed) : Result<void>{};
    }

    void close() override { beast::get_lowest_layer(ws_).close(); }

private:
    asio::awaitable<Result<void>> send(std::string message) override {
        const auto [failed, sent] =
            co_await ws_.async_write(asio::buffer(message), asio::as_tuple(asio::use_awaitable));
        co_return failed ? Result<void>(failed) : Result<void>{};
    }

    asio::awaitable<Result<std::span<const std::uint8_t>>> receive_bytes() override {
        buffer_.clear();
        const auto [failed, got] =
            co_await ws_.async_read(buffer_, asio::as_tuple(asio::use_awaitable));
        if (failed == websocket::error::closed) {
            co_return asio::error::make_error_code(asio::error::eof);
        }
        if (failed) {
            co_return failed;
        }
        const auto header = got < 126 ? 2U : (got < 65536 ? 4U : 10U);
        bytes_received_ += got + header;
        co_return std::span(static_cast<const std::uint8_t*>(buffer_.cdata().data()), got);
    }

    websocket::stream<beast::tcp_stream> ws_;
    beast::flat_buffer buffer_{longest_server_message};
};

}  // namespace

asio::awaitable<Result<std::unique_ptr<StreamClient>>>
make_ws_client(asio::ip::tcp::socket socket, StreamUrl url) {
    auto client = std::make_unique<WsClient>(std::move(socket));
    if (auto shaken = co_await client->shake_hands(url); !shaken) {
        co_return shaken.error();
    }
    co_return std::unique_ptr<StreamClient>(std::move(client));
}

}  // namespace sweepcast::client
