#include "server/http/host_names.hpp"

#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/host_name.hpp>

#include <algorithm>
#include <optional>
#include <utility>

namespace sweepcast::http {

namespace asio = boost::asio;

namespace {

constexpr std::size_t longest_name = 253;  // RFC 1035, 2.3.4, as text

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

bool is_name_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '-' || c == '_';
}

/// Returns the name in lower case and without a dot at its end.
std::string normal(std::string_view name) {
    if (name.ends_with('.')) {
        name.remove_suffix(1);
    }
    std::string text(name);
    std::ranges::transform(text, text.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return text;
}

/// Returns the host in a Host header, without its port; nothing if the port is no number.
std::optional<std::string_view> without_port(std::string_view header) {
    const auto bracket = header.starts_with('[') ? header.find(']') : 0;
    if (bracket == std::string_view::npos) {
        return std::nullopt;
    }
    const auto colon = header.find(':', bracket);
    const auto host = header.substr(0, colon);
    const auto port = colon == std::string_view::npos ? "" : header.substr(colon + 1);
    return std::ranges::all_of(port, is_digit) ? std::optional(host) : std::nullopt;
}

bool is_address(std::string_view host) {
    boost::system::error_code no_address;
    if (host.starts_with('[') && host.ends_with(']')) {
        const std::string inside(host.substr(1, host.size() - 2));
        (void)asio::ip::make_address_v6(inside, no_address);
    } else {
        (void)asio::ip::make_address_v4(std::string(host), no_address);
    }
    return !no_address;
}

}  // namespace

HostNames::HostNames(std::vector<std::string> names) : names_(std::move(names)) {
    std::ranges::transform(names_, names_.begin(), [](const auto& name) { return normal(name); });
}

HostCheck HostNames::check(std::string_view header) const {
    const auto host = without_port(header);
    if (!host) {
        return HostCheck::malformed;
    }
    if (is_address(*host)) {
        return HostCheck::ours;
    }
    if (!is_host_name(*host)) {
        return HostCheck::malformed;
    }
    const auto name = normal(*host);
    const bool is_ours = name == "localhost" || name.ends_with(".localhost") ||
                         std::ranges::find(names_, name) != names_.end();
    return is_ours ? HostCheck::ours : HostCheck::other;
}

bool is_host_name(std::string_view text) {
    if (text.ends_with('.')) {
        text.remove_suffix(1);
    }
    const bool has_empty_part = text.empty() || text.starts_with('.') || text.ends_with('.') ||
                                text.find("..") != std::string_view::npos;
    return !has_empty_part && text.size() <= longest_name &&
           std::ranges::all_of(text, [](char c) { return c == '.' || is_name_character(c); });
}

std::vector<std::string> names_of(std::string_view host_name) {
    if (!is_host_name(host_name)) {
        return {};
    }
    const auto name = normal(host_name);
    const auto first = name.substr(0, name.find('.'));
    return {name, first, first + ".local"};
}

std::vector<std::string> own_host_names() {
    boost::system::error_code failed;
    const auto name = asio::ip::host_name(failed);
    return failed ? std::vector<std::string>{} : names_of(name);
}

}  // namespace sweepcast::http
