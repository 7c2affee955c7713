#include "server/stream/ws_transport.hpp"

#include "server/stream/messages.hpp"
#include "server/stream/outbox_stream.hpp"
#include "server/stream/tcp_transport.hpp"
#include "server/version.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/websocket.hpp>

#include <array>
#include <chrono>
#include <string>
#include <utility>

namespace sweepcast::stream {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using namespace std::chrono_literals;

namespace {

/// Without permessage-deflate: frames are compressed once for all, or not at all.
using WsStream = websocket::stream<OutboxStream, false>;

class WsTransport final : public Transport {
public:
    WsTransport(asio::ip::tcp::socket socket, std::string unread)
        : outbox_(std::move(socket), frame::Framing::websocket)
        , ws_(outbox_, std::move(unread)) {
        set_stream_options(outbox_.socket());
        // A client that neither reads nor answers a ping is cut off. Frames do not go through Beast
        // and so do not put the pings off: one may reach a client that has just stopped reading,
        // and has to wait until it reads on.
        ws_.set_option(websocket::stream_base::timeout{
            .handshake_timeout = 10s,
            .idle_timeout = 180s,
            .keep_alive_pings = true});
        ws_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
            response.set(beast::http::field::server, std::string("sweepcast ") + version);
        }));
        ws_.read_message_max(longest_client_message);
    }

    asio::awaitable<Result<void>> accept(
        const beast::http::request<beast::http::string_body>& request
    ) {
        const auto [failed] =
            co_await ws_.async_accept(request, asio::as_tuple(asio::use_awaitable));
        co_return failed ? Result<void>(failed) : Result<void>{};
    }

    hub::Outbox& outbox() override { return outbox_; }

    asio::awaitable<Result<std::string>> receive() override {
        std::string message;  // of longest_client_message at most, which Beast sees to
        do {
            std::array<char, 128> chunk{};  // a Subscribe fits; every client keeps it
            const auto [failed, got] = co_await ws_.async_read_some(
                asio::buffer(chunk),
                asio::as_tuple(asio::use_awaitable)
            );
            if (failed) {
                co_return failed;
            }
            message.append(chunk.data(), got);
        } while (!ws_.is_message_done());
        co_return message;
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
    hub::Outbox outbox_;
    WsStream ws_;
};

}  // namespace

asio::awaitable<Result<std::unique_ptr<Transport>>> accept_websocket(
    asio::ip::tcp::socket socket,
    beast::http::request<beast::http::string_body> request,
    std::string unread
) {
    auto transport = std::make_unique<WsTransport>(std::move(socket), std::move(unread));
    if (auto accepted = co_await transport->accept(request); !accepted) {
        co_return accepted.error();
    }
    co_return std::unique_ptr<Transport>(std::move(transport));
}

}  // namespace sweepcast::stream
