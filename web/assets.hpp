// The page's files, built into the program.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace sweepcast::web {

/// One file of the page. Everything it refers to lives as long as the program.
struct Asset {
    std::string_view path;          ///< as in a request: "/app.js"
    std::string_view content_type;  ///< "text/javascript; charset=utf-8"
    std::string_view etag;  ///< with its quotes, as the header wants it; changes with the content
    std::span<const std::uint8_t> identity;  ///< the content, for clients that cannot unpack
    std::span<const std::uint8_t> gzip;      ///< the content, for Content-Encoding: gzip
};

/// All files of the page; "/" is to be answered with "/index.html".
std::span<const Asset> assets();

}  // namespace sweepcast::web
