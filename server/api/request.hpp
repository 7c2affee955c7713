// An HTTP request and response as values, without the socket they came by.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sweepcast::api {

struct Request {
    std::string method;  ///< "GET", "POST", ...
    std::string path;    ///< decoded, without the query: "/api/v1/lidars"
    std::vector<std::pair<std::string, std::string>> query;  ///< decoded, in order
    std::string accept;                                      ///< the Accept header
    std::string body;

    /// The value of the first query parameter called `key`, or empty.
    [[nodiscard]] std::string_view parameter(std::string_view key) const;
};

struct Response {
    int status{200};
    std::string content_type{"application/json"};
    std::string body;
    std::vector<std::pair<std::string, std::string>> headers;
};

/// Splits and decodes a request target such as "/api/v1/lidars?x=%20". False if it is no valid one.
[[nodiscard]] bool set_target(Request& request, std::string_view target);

/// True if a browser's request may be served: it has no Origin, or one of the very host it was sent
/// to. Pages of other sites may not command a scanner just because its owner visits them.
[[nodiscard]] bool same_origin(std::string_view origin, std::string_view host);

}  // namespace sweepcast::api
