#include "server/stream/ws_transport.hpp"

#include "server/stream/messages.hpp"
#include "server/stream/tcp_transport.hpp"
#include "server/version.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>

#include <chrono>
#include <string>
#include <utility>

namespace sweepcast::stream {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using namespace std::chrono_literals;

namespace {

using WsStream = websocket::stream<beast::tcp_stream>;

class WsTransport final : public Transport {
public:
    explicit WsTransport(beast::tcp_stream stream) : ws_(std::move(stream)) {
        set_stream_options(ws_.next_layer().socket());
        // A client that neither reads nor answers a ping for `idle` is cut off.
        ws_.set_option(websocket::stream_base::timeout{
            .handshake_timeout = 10s,
            .idle_timeout = 120s,
            .keep_alive_pings = true});
        ws_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
            response.set(beast::http::field::server, std::string("sweepcast ") + version);
        }));
        ws_.read_message_max(longest_client_message);
        // Without this Beast copies every message above 4 kB into pieces.
        ws_.auto_fragment(false);
        ws_.binary(true);
    }

    asio::awaitable<Result<void>> accept(
        const beast::http::request<beast::http::string_body>& request
    ) {
        const auto [failed] =
            co_await ws_.async_accept(request, asio::as_tuple(asio::use_awaitable));
        co_return failed ? Result<void>(failed) : Result<void>{};
    }

    asio::awaitable<Result<void>> send(const frame::WireMessage& message) override {
        const auto bytes = message.message();
        const auto [failed, sent] = co_await ws_.async_write(
            asio::buffer(bytes.data(), bytes.size()),
            asio::as_tuple(asio::use_awaitable)
        );
        co_return failed ? Result<void>(failed) : Result<void>{};
    }

    asio::awaitable<Result<std::string>> receive() override {
        buffer_.clear();
        const auto [failed, got] =
            co_await ws_.async_read(buffer_, asio::as_tuple(asio::use_awaitable));
        if (failed) {
            co_return failed;
        }
        co_return beast::buffers_to_string(buffer_.cdata());
    }

    asio::awaitable<void> close(const std::string& reason) override {
        ws_.set_option(websocket::stream_base::timeout{
            .handshake_timeout = 500ms,
            .idle_timeout = 500ms,
            .keep_alive_pings = false});
        const websocket::close_reason why(websocket::close_code::going_away, reason.substr(0, 100));
        // The peer may have gone already, or not answer: either way the connection ends here.
        (void)co_await ws_.async_close(why, asio::as_tuple(asio::use_awaitable));
    }

private:
    WsStream ws_;
    beast::flat_buffer buffer_{longest_client_message};
};

}  // namespace

asio::awaitable<Result<std::unique_ptr<Transport>>>
accept_websocket(beast::tcp_stream stream, beast::http::request<beast::http::string_body> request) {
    auto transport = std::make_unique<WsTransport>(std::move(stream));
    if (auto accepted = co_await transport->accept(request); !accepted) {
        co_return accepted.error();
    }
    co_return std::unique_ptr<Transport>(std::move(transport));
}

}  // namespace sweepcast::stream
