#include "server/gateway/lidar_url.hpp"

#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>
#include <fmt/format.h>

#include <utility>

namespace sweepcast::gateway {

namespace {

constexpr std::string_view virtual_scheme = "virtual:";

Problem bad_url(std::string_view text, std::string_view what) {
    return {
        make_error_code(boost::system::errc::invalid_argument),
        fmt::format("lidar \"{}\": {}", text, what),
        "write a serial port such as /dev/ttyUSB0, or virtual:a1m8, or virtual:a1m8?world=FILE"};
}

Result<VirtualLidarUrl, Problem> parse_virtual(std::string_view text) {
    const auto url = boost::urls::parse_uri(text);
    if (!url || url->path().empty()) {
        return bad_url(text, "not a URL of a virtual lidar");
    }
    VirtualLidarUrl lidar{url->path(), ""};
    for (const auto& parameter : url->params()) {
        if (parameter.key != "world") {
            return bad_url(
                text,
                fmt::format("unknown parameter \"{}\"", std::string(parameter.key))
            );
        }
        lidar.world = parameter.value;
    }
    return lidar;
}

}  // namespace

Result<LidarUrl, Problem> parse_lidar_url(std::string_view text) {
    if (text.starts_with(virtual_scheme)) {
        auto lidar = parse_virtual(text);
        if (!lidar) {
            return lidar.error();
        }
        return LidarUrl{std::string(text), std::move(*lidar), false};
    }
    if (text.empty() || text.find("://") != std::string_view::npos) {
        return bad_url(text, "not a port or URL known here");
    }
    return LidarUrl{std::string(text), SerialLidar{std::string(text)}, false};
}

std::string port_name(const LidarUrl& url) {
    if (const auto* serial = std::get_if<SerialLidar>(&url.where)) {
        return serial->path.substr(
            serial->path.rfind('/') + 1
        );  // npos + 1 is 0: no slash, whole path
    }
    return "virtual-" + std::get<VirtualLidarUrl>(url.where).model;
}

}  // namespace sweepcast::gateway
