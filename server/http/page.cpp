#include "server/http/page.hpp"

#include "web/assets.hpp"

#include <algorithm>

namespace sweepcast::http {

namespace {

/// Nothing but the page's own files may run or be loaded; its stream and API are of the same
/// origin.
constexpr const char* content_policy =
    "default-src 'self'; connect-src 'self' ws: wss:; style-src 'self'; img-src 'self' data:; "
    "object-src 'none'; "
    "base-uri 'none'; frame-ancestors 'none'";

std::string text(std::span<const std::uint8_t> bytes) {
    return {bytes.begin(), bytes.end()};
}

}  // namespace

std::optional<api::Response> page_response(
    std::string_view path,
    std::string_view accept_encoding,
    std::string_view if_none_match
) {
    const auto wanted = path == "/" ? std::string_view("/index.html") : path;
    const auto files = web::assets();
    const auto file = std::ranges::find(files, wanted, &web::Asset::path);
    if (file == files.end()) {
        return std::nullopt;
    }
    api::Response response;
    response.content_type = file->content_type;
    response.headers = {
        {"ETag", std::string(file->etag)},
        {"Cache-Control", "no-cache"},  // may be kept, but asked about each time
        {"Vary", "Accept-Encoding"},
        {"Content-Security-Policy", content_policy},
    };
    if (if_none_match.find(file->etag) != std::string_view::npos) {
        response.status = 304;
        return response;
    }
    const bool gzip = accept_encoding.find("gzip") != std::string_view::npos;
    response.body = text(gzip ? file->gzip : file->identity);
    if (gzip) {
        response.headers.emplace_back("Content-Encoding", "gzip");
    }
    return response;
}

}  // namespace sweepcast::http
