#include "server/gateway/lidar_url.hpp"

#include "driver/protocol/printable.hpp"

#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>
#include <vector>

namespace sweepcast::gateway {

namespace {

constexpr std::string_view virtual_scheme = "virtual:";
constexpr std::string_view remote_scheme = "sweepcast:";
constexpr std::size_t longest_name = 64;
constexpr std::size_t longest_mode = 64;

using Parameters = std::vector<link::UrlParameter>;

Problem bad_url(std::string_view text, std::string_view what, std::string hint) {
    return {
        make_error_code(boost::system::errc::invalid_argument),
        fmt::format("lidar \"{}\": {}", text, what),
        std::move(hint)};
}

Result<LidarUrl, Problem> parse_virtual(std::string_view text, Parameters& others) {
    // A schedule has spaces in it, and people write them as they are.
    std::string encoded;
    for (const char c : text) {
        encoded += c == ' ' ? "%20" : std::string(1, c);
    }
    const auto url = boost::urls::parse_uri(encoded);
    if (!url || url->path().empty()) {
        return bad_url(
            text,
            "not a URL of a virtual lidar",
            "write virtual:a1m8, or virtual:a1m8?world=FILE"
        );
    }
    VirtualLidarUrl lidar{.model = url->path()};
    for (const auto& parameter : url->params()) {
        if (parameter.key == "world") {
            lidar.world = parameter.value;
        } else if (parameter.key == "fault") {
            lidar.faults.emplace_back(parameter.value);
        } else if (parameter.key == "schedule") {
            lidar.schedule.emplace_back(parameter.value);
        } else if (parameter.key == "control") {
            lidar.control = parameter.value;
        } else {
            others.push_back({std::string(parameter.key), std::string(parameter.value)});
        }
    }
    return LidarUrl{std::string(text), std::move(lidar)};
}

bool is_port(std::string_view text) {
    std::uint16_t port{};
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), port);
    return failed == std::errc() && end == text.data() + text.size() && port > 0;
}

Result<LidarUrl, Problem> parse_remote(std::string_view text, Parameters& others) {
    const auto bad = bad_url(
        text,
        "not a URL of another gateway's lidar",
        "write sweepcast://HOST:PORT/ID, such as sweepcast://robot:8081/A0E1C2D3; the port is that "
        "of its stream (8081), and with one lidar only the ID may be left out"
    );
    const auto url = boost::urls::parse_uri(text);
    if (!url || url->host().empty() || url->has_fragment() || url->has_userinfo()) {
        return bad;
    }
    RemoteLidarUrl remote{url->host_address(), "8081", {}};
    if (url->has_port()) {
        remote.port = url->port();
    }
    const std::string path = url->path();
    if (!path.empty()) {
        remote.id = path.substr(1);
    }
    const bool odd_path = !path.empty() && path.front() != '/';
    if (odd_path || !is_port(remote.port) || (!remote.id.empty() && !is_lidar_name(remote.id))) {
        return bad;
    }
    for (const auto& parameter : url->params()) {
        if (parameter.key == "mode" || parameter.key == "hz") {
            return bad_url(
                text,
                fmt::format("its own gateway sets its {}", std::string(parameter.key)),
                "leave it out here; only name=ID can be given"
            );
        }
        others.push_back({std::string(parameter.key), std::string(parameter.value)});
    }
    return LidarUrl{std::string(text), std::move(remote)};
}

Result<LidarUrl, Problem> parse_place(std::string_view text, Parameters& others) {
    if (text.starts_with(virtual_scheme)) {
        return parse_virtual(text, others);
    }
    if (text.starts_with(remote_scheme)) {
        return parse_remote(text, others);
    }
    auto url = link::parse_link_url(text, others);
    if (!url) {
        auto problem = url.error();
        problem.cause = "lidar " + problem.cause;
        problem.hint +=
            "; or a virtual lidar: virtual:a1m8; or another gateway's: "
            "sweepcast://HOST:8081/ID";
        return problem;
    }
    return LidarUrl{std::string(text), std::move(*url)};
}

std::optional<double> parse_hz(std::string_view text) {
    double hz{};
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), hz);
    const bool is_number = ec == std::errc() && end == text.data() + text.size();
    // Written so that NaN fails.
    return is_number && hz >= slowest_hz && hz <= fastest_hz ? std::optional(hz) : std::nullopt;
}

std::optional<std::chrono::seconds> parse_patience(std::string_view text) {
    std::int64_t seconds{};
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), seconds);
    const bool is_number = ec == std::errc() && end == text.data() + text.size();
    return is_number && seconds >= 1 && seconds <= longest_patience.count()
               ? std::optional(std::chrono::seconds(seconds))
               : std::nullopt;
}

/// Takes in one of the parameters that any lidar may have.
Result<void, Problem> apply(LidarUrl& url, const link::UrlParameter& parameter) {
    if (parameter.key == "name") {
        if (!is_lidar_name(parameter.value)) {
            return bad_url(
                url.text,
                fmt::format(
                    "\"{}\" cannot be a lidar's name",
                    protocol::printable(parameter.value)
                ),
                fmt::format("a name has 1 to {} of A-Z a-z 0-9 . _ -, not only dots", longest_name)
            );
        }
        url.name = parameter.value;
        return {};
    }
    if (parameter.key == "mode") {
        if (parameter.value.empty() || parameter.value.size() > longest_mode) {
            return bad_url(
                url.text,
                "names no scan mode",
                "write the mode's name or id, such as mode=Boost or mode=2"
            );
        }
        url.mode = parameter.value;
        return {};
    }
    if (parameter.key == "hz") {
        url.hz = parse_hz(parameter.value);
        if (!url.hz) {
            return bad_url(
                url.text,
                fmt::format("\"{}\" is no rotation speed", protocol::printable(parameter.value)),
                fmt::format("write rotations per second, {} to {}", slowest_hz, fastest_hz)
            );
        }
        return {};
    }
    if (parameter.key == "motor_off_after") {
        url.motor_off_after = parse_patience(parameter.value);
        if (!url.motor_off_after) {
            return bad_url(
                url.text,
                fmt::format("\"{}\" is no time to wait", protocol::printable(parameter.value)),
                fmt::format("write seconds, 1 to {}", longest_patience.count())
            );
        }
        return {};
    }
    return bad_url(
        url.text,
        fmt::format("unknown parameter \"{}\"", protocol::printable(parameter.key)),
        "there are: name=ID, mode=NAME, hz=SPEED, motor_off_after=SECONDS; for a serial "
        "port also baud=RATE, as in /dev/ttyUSB0?baud=256000; for a virtual lidar world=FILE, "
        "fault=FAULT, schedule=TEXT and control=PATH, as in virtual:a1m8?world=FILE"
    );
}

}  // namespace

Result<LidarUrl, Problem> parse_lidar_url(std::string_view text) {
    Parameters others;
    auto url = parse_place(text, others);
    if (!url) {
        return url;
    }
    for (const auto& parameter : others) {
        if (auto applied = apply(*url, parameter); !applied) {
            return applied.error();
        }
    }
    return url;
}

bool is_lidar_name(std::string_view name) {
    // "." and ".." are not what they seem in the path of a URL.
    return name.find_first_not_of('.') != std::string_view::npos && name.size() <= longest_name &&
           std::all_of(name.begin(), name.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '.' || c == '_' || c == '-';
           });
}

std::string port_name(const LidarUrl& url) {
    if (const auto* remote = std::get_if<RemoteLidarUrl>(&url.where)) {
        if (!remote->id.empty()) {
            return remote->id;
        }
        return is_lidar_name(remote->host) ? remote->host : "gateway";
    }
    if (const auto* way = std::get_if<link::LinkUrl>(&url.where)) {
        return link::short_name(*way);
    }
    return "virtual-" + std::get<VirtualLidarUrl>(url.where).model;
}

std::optional<Problem> name_clash(const std::vector<LidarUrl>& lidars) {
    for (auto lidar = lidars.begin(); lidar != lidars.end(); ++lidar) {
        const auto same = std::find_if(lidars.begin(), lidar, [&](const LidarUrl& earlier) {
            return !lidar->name.empty() && earlier.name == lidar->name;
        });
        if (same != lidar) {
            return Problem{
                make_error_code(boost::system::errc::invalid_argument),
                fmt::format(
                    "two lidars are named \"{}\": {} and {}",
                    lidar->name,
                    same->text,
                    lidar->text
                ),
                "give each a name of its own, or none: it then goes by its serial number"};
        }
    }
    return std::nullopt;
}

}  // namespace sweepcast::gateway
