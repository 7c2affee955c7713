// Telling paths from URLs, and taking URLs apart with Boost.URL.
#include "driver/link/link_url.hpp"

#include "driver/protocol/printable.hpp"

#include <boost/url/parse.hpp>
#include <boost/url/parse_query.hpp>
#include <boost/url/url_view.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace sweepcast::link {

namespace urls = boost::urls;

namespace {

constexpr const char* what_is_accepted =
    "write a serial port such as /dev/ttyUSB0 or /dev/ttyUSB0?baud=256000, or tcp://HOST:20108, or "
    "udp://HOST:8089";

Problem bad_url(std::string_view text, std::string_view what, std::string hint = what_is_accepted) {
    return {
        make_error_code(boost::system::errc::invalid_argument),
        fmt::format("\"{}\": {}", text, what),
        std::move(hint)};
}

constexpr bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// The part before the first ':' if it can be a scheme; a path with a ':' further on has none.
std::string_view scheme_of(std::string_view text) {
    const auto scheme = text.substr(0, text.find(':'));
    const bool well_formed = std::all_of(scheme.begin(), scheme.end(), [](char c) {
        return is_letter(c) || (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
    });
    return scheme.size() < text.size() && !scheme.empty() && is_letter(scheme[0]) && well_formed
               ? scheme
               : std::string_view();
}

template <class Parameters>
std::vector<UrlParameter> copy_of(const Parameters& parameters) {
    std::vector<UrlParameter> copy;
    for (const auto& parameter : parameters) {
        copy.push_back({std::string(parameter.key), std::string(parameter.value)});
    }
    return copy;
}

std::optional<std::uint32_t> parse_baud(const std::string& text) {
    std::uint32_t baud{};
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), baud);
    if (ec != std::errc() || end != text.data() + text.size() || baud < lowest_baud ||
        baud > highest_baud) {
        return std::nullopt;
    }
    return baud;
}

/// Not by Boost.URL 1.81, whose port_number() takes "99999" for 34463.
std::optional<std::uint16_t> parse_port(std::string_view text) {
    std::uint16_t port{};
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), port);
    return ec == std::errc() && end == text.data() + text.size() && port != 0 ? std::optional(port)
                                                                              : std::nullopt;
}

/// Takes "baud" out of the parameters; the rest is not the port's.
Result<LinkUrl, Problem> serial_url(
    std::string_view text,
    std::string path,
    std::vector<UrlParameter> parameters,
    std::vector<UrlParameter>& others
) {
    if (path.empty()) {
        return bad_url(text, "names no serial port");
    }
    if (path.find('\0') != std::string::npos) {
        return bad_url(text, "a path cannot have a zero byte");
    }
    SerialPlace place{std::move(path), std::nullopt};
    for (auto& parameter : parameters) {
        if (parameter.key != "baud") {
            others.push_back(std::move(parameter));
            continue;
        }
        place.baud = parse_baud(parameter.value);
        if (!place.baud) {
            return bad_url(
                text,
                fmt::format("\"{}\" is no line speed", protocol::printable(parameter.value)),
                fmt::format(
                    "write bits per second, from {} to {}; RPLIDARs use 115200, 256000, 460800 and "
                    "1000000",
                    lowest_baud,
                    highest_baud
                )
            );
        }
    }
    return LinkUrl{std::string(text), std::move(place)};
}

Result<LinkUrl, Problem> path_url(std::string_view text, std::vector<UrlParameter>& others) {
    const auto mark = text.find('?');
    std::vector<UrlParameter> parameters;
    if (mark != std::string_view::npos) {
        const auto query = urls::parse_query(text.substr(mark + 1));
        if (!query) {
            return bad_url(text, "what follows the '?' is not well-formed");
        }
        parameters = copy_of(urls::params_view(*query));
    }
    return serial_url(text, std::string(text.substr(0, mark)), std::move(parameters), others);
}

template <class Place>
Result<LinkUrl, Problem> network_url(
    std::string_view text,
    const urls::url_view& url,
    std::uint16_t default_port,
    std::vector<UrlParameter>& others
) {
    const std::string_view path = url.encoded_path();
    if (!url.has_authority() || url.host_address().empty()) {
        return bad_url(text, "names no host");
    }
    // Boost.URL 1.81 takes the "x" of "tcp://robot:x" for a path.
    if (!path.empty() && path != "/" && !url.is_path_absolute()) {
        return bad_url(text, "the port is not a number");
    }
    if ((!path.empty() && path != "/") || url.has_userinfo() || url.has_fragment()) {
        return bad_url(text, "has more than a host and a port");
    }
    const bool names_port = url.has_port() && !url.port().empty();
    const auto port = names_port ? parse_port(url.port()) : std::optional(default_port);
    if (!port) {
        return bad_url(text, "the port is not from 1 to 65535");
    }
    auto parameters = copy_of(url.params());
    const auto baud = std::find_if(parameters.begin(), parameters.end(), [](const auto& parameter) {
        return parameter.key == "baud";
    });
    if (baud != parameters.end()) {
        return bad_url(
            text,
            "a network link has no baud rate",
            "leave it out; the line speed is set at the serial bridge"
        );
    }
    others = std::move(parameters);
    return LinkUrl{std::string(text), Place{url.host_address(), *port}};
}

}  // namespace

Result<LinkUrl, Problem> parse_link_url(std::string_view text, std::vector<UrlParameter>& others) {
    others.clear();
    const auto scheme = scheme_of(text);
    if (scheme.empty()) {
        return path_url(text, others);
    }
    if (scheme != "serial" && scheme != "tcp" && scheme != "udp") {
        return bad_url(
            text,
            fmt::format("\"{}:\" is not known here", scheme),
            fmt::format("{}; a path that looks like a URL is written ./{}", what_is_accepted, text)
        );
    }
    const auto url = urls::parse_uri(text);
    if (!url) {
        return bad_url(text, "not a well-formed URL");
    }
    if (scheme == "tcp") {
        return network_url<TcpPlace>(text, *url, default_tcp_port, others);
    }
    if (scheme == "udp") {
        return network_url<UdpPlace>(text, *url, default_udp_port, others);
    }
    if (url->has_authority() && !url->host().empty()) {
        return bad_url(text, "a serial port has no host", "write serial:/dev/ttyUSB0");
    }
    return serial_url(text, url->path(), copy_of(url->params()), others);
}

Result<LinkUrl, Problem> parse_link_url(std::string_view text) {
    std::vector<UrlParameter> others;
    auto url = parse_link_url(text, others);
    if (url && !others.empty()) {
        return bad_url(
            text,
            fmt::format("unknown parameter \"{}\"", protocol::printable(others.front().key))
        );
    }
    return url;
}

std::string short_name(const LinkUrl& url) {
    if (const auto* serial = std::get_if<SerialPlace>(&url.where)) {
        return serial->path.substr(serial->path.rfind('/') + 1);  // npos + 1 is 0: the whole path
    }
    if (const auto* tcp = std::get_if<TcpPlace>(&url.where)) {
        return tcp->host;
    }
    return std::get<UdpPlace>(url.where).host;
}

}  // namespace sweepcast::link
