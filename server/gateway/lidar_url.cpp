#include "server/gateway/lidar_url.hpp"

#include "driver/link/small_file.hpp"

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
    const auto url = boost::urls::parse_uri(text);
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
        } else {
            others.push_back({std::string(parameter.key), std::string(parameter.value)});
        }
    }
    return LidarUrl{std::string(text), std::move(lidar)};
}

Result<LidarUrl, Problem> parse_place(std::string_view text, Parameters& others) {
    if (text.starts_with(virtual_scheme)) {
        return parse_virtual(text, others);
    }
    auto url = link::parse_link_url(text, others);
    if (!url) {
        auto problem = url.error();
        problem.cause = "lidar " + problem.cause;
        problem.hint += "; or a virtual lidar: virtual:a1m8";
        return problem;
    }
    return LidarUrl{std::string(text), std::move(*url)};
}

bool is_name(std::string_view name) {
    // "." and ".." are not what they seem in the path of a URL.
    return name.find_first_not_of('.') != std::string_view::npos && name.size() <= longest_name &&
           std::all_of(name.begin(), name.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '.' || c == '_' || c == '-';
           });
}

std::optional<double> parse_hz(std::string_view text) {
    double hz{};
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), hz);
    const bool is_number = ec == std::errc() && end == text.data() + text.size();
    // Written so that NaN fails.
    return is_number && hz >= slowest_hz && hz <= fastest_hz ? std::optional(hz) : std::nullopt;
}

/// Takes in one of the parameters that any lidar may have.
Result<void, Problem> apply(LidarUrl& url, const link::UrlParameter& parameter) {
    if (parameter.key == "name") {
        if (!is_name(parameter.value)) {
            return bad_url(
                url.text,
                fmt::format("\"{}\" cannot be a lidar's name", link::printable(parameter.value)),
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
                fmt::format("\"{}\" is no rotation speed", link::printable(parameter.value)),
                fmt::format("write rotations per second, {} to {}", slowest_hz, fastest_hz)
            );
        }
        return {};
    }
    return bad_url(
        url.text,
        fmt::format("unknown parameter \"{}\"", link::printable(parameter.key)),
        "there are: name=ID, mode=NAME, hz=SPEED; for a serial port also baud=RATE, as in "
        "/dev/ttyUSB0?baud=256000; for a virtual lidar world=FILE and "
        "fault=FAULT, as in virtual:a1m8?world=FILE"
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

std::string port_name(const LidarUrl& url) {
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
