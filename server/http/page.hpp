// The page's files, as responses.
#pragma once

#include "server/api/request.hpp"

#include <optional>
#include <string_view>

namespace sweepcast::http {

/// The file at `path` ("/" is the page itself), or nothing. `accept_encoding` and `if_none_match`
/// are the request's headers: a browser gets the gzip form, and 304 for what it has already.
[[nodiscard]] std::optional<api::Response> page_response(
    std::string_view path,
    std::string_view accept_encoding,
    std::string_view if_none_match
);

}  // namespace sweepcast::http
