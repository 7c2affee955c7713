// The two kinds of connection behind StreamClient.
#pragma once

#include "server/client/stream_client.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <memory>

namespace sweepcast::client {

[[nodiscard]] std::unique_ptr<StreamClient> make_tcp_client(boost::asio::ip::tcp::socket socket);

/// Shakes hands on a connected socket.
/// Errors: the handshake's; a refusal is boost::beast::websocket::error::upgrade_declined.
[[nodiscard]] boost::asio::awaitable<Result<std::unique_ptr<StreamClient>>>
make_ws_client(boost::asio::ip::tcp::socket socket, StreamUrl url);

}  // namespace sweepcast::client
