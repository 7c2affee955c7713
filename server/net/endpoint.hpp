// Addresses to listen on, as users write them.
#pragma once

#include "driver/protocol/result.hpp"

#include <boost/asio/ip/tcp.hpp>

#include <string>
#include <string_view>

namespace sweepcast::net {

/// Reads "127.0.0.1:8080", "[::1]:8080", "localhost:8080" or "0.0.0.0:8080"; port 0 lets the system
/// choose. The Problem says what is wrong with the text.
[[nodiscard]] Result<boost::asio::ip::tcp::endpoint, Problem> parse_endpoint(std::string_view text);

/// The endpoint as users write it: "127.0.0.1:8080", "[::1]:8080".
[[nodiscard]] std::string to_text(const boost::asio::ip::tcp::endpoint& endpoint);

/// The endpoint as a client on this machine can call it: an unspecified address (0.0.0.0, [::]),
/// which one can listen on but not connect to everywhere, becomes the loopback address.
[[nodiscard]] boost::asio::ip::tcp::endpoint callable(const boost::asio::ip::tcp::endpoint& endpoint
);

}  // namespace sweepcast::net
