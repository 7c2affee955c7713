// Messages over WebSocket, each one binary message.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/stream/transport.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include <memory>

namespace sweepcast::stream {

/// Answers a client's upgrade request on `stream`, which must have no deadline set.
/// Errors: those of the handshake.
[[nodiscard]] boost::asio::awaitable<Result<std::unique_ptr<Transport>>> accept_websocket(
    boost::beast::tcp_stream stream,
    boost::beast::http::request<boost::beast::http::string_body> request
);

}  // namespace sweepcast::stream
