#include "server/client/stream_url.hpp"

#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>
#include <fmt/format.h>

namespace sweepcast::client {

Result<StreamUrl, Problem> parse_stream_url(std::string_view text) {
    const Problem bad{
        make_error_code(boost::system::errc::invalid_argument),
        fmt::format("\"{}\" is not a stream's URL", text),
        "write tcp://HOST:PORT or ws://HOST:PORT/api/v1/stream, for example tcp://127.0.0.1:8081"};
    const auto parsed = boost::urls::parse_uri(text);
    // Boost.URL 1.81 takes the "x" of "tcp://robot:x" for a path.
    const bool odd_path = parsed && !parsed->encoded_path().empty() && !parsed->is_path_absolute();
    if (!parsed || parsed->host().empty() || odd_path) {
        return bad;
    }
    StreamUrl url;
    url.websocket = parsed->scheme() == "ws";
    if (!url.websocket && parsed->scheme() != "tcp") {
        return bad;
    }
    url.host = parsed->host_address();
    url.port = parsed->has_port() ? std::string(parsed->port()) : (url.websocket ? "8080" : "8081");
    if (!url.websocket && parsed->has_query()) {
        return Problem{
            bad.code,
            fmt::format("\"{}\": a tcp URL takes no query", text),
            "say what to get with options, for example --lidar ID --compression none"};
    }
    const std::string_view path = parsed->encoded_path();
    url.target = path.empty() || path == "/" ? "/api/v1/stream" : path;
    if (parsed->has_query()) {
        url.target += "?" + std::string(parsed->encoded_query());
    }
    return url;
}

std::string StreamUrl::url_host() const {
    return host.find(':') != std::string::npos ? "[" + host + "]" : host;
}

}  // namespace sweepcast::client
