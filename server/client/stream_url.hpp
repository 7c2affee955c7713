// Where a stream is, as users write it: tcp://HOST:PORT or ws://HOST:PORT/PATH.
#pragma once

#include "driver/protocol/result.hpp"

#include <string>
#include <string_view>

namespace sweepcast::client {

struct StreamUrl {
    bool websocket{};
    std::string host;
    std::string port;
    std::string target;  ///< path and query; of a WebSocket only

    /// The host as URLs and Host headers have it: an IPv6 address in brackets.
    [[nodiscard]] std::string url_host() const;
    /// Whether it says what to get.
    [[nodiscard]] bool has_query() const { return target.find('?') != std::string::npos; }
};

/// Ports default to 8081 (tcp) and 8080 (ws), a WebSocket's path to /api/v1/stream. Only a
/// WebSocket may have a query: a TCP stream has nowhere to send it. The Problem says what to write
/// instead.
[[nodiscard]] Result<StreamUrl, Problem> parse_stream_url(std::string_view text);

}  // namespace sweepcast::client
