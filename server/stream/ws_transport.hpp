// Messages over WebSocket, each one binary message.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/stream/transport.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include <memory>
#include <string>

namespace sweepcast::stream {

/// Answers a client's upgrade request on `socket`. `unread` is what the client has already sent
/// after the request: the first bytes of the stream.
/// Errors: those of the handshake.
[[nodiscard]] boost::asio::awaitable<Result<std::unique_ptr<Transport>>> accept_websocket(
    boost::asio::ip::tcp::socket socket,
    boost::beast::http::request<boost::beast::http::string_body> request,
    std::string unread
);

}  // namespace sweepcast::stream
