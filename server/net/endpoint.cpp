#include "server/net/endpoint.hpp"

#include <boost/asio/ip/address.hpp>
#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <optional>

namespace sweepcast::net {

using boost::asio::ip::tcp;

namespace {

std::optional<std::uint16_t> parse_port(std::string_view text) {
    std::uint16_t port = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (failure != std::errc{} || end != text.data() + text.size()) {
        return std::nullopt;
    }
    return port;
}

std::optional<boost::asio::ip::address> parse_address(std::string_view text) {
    if (text == "localhost") {
        return boost::asio::ip::address_v4::loopback();
    }
    const bool bracketed = text.size() >= 2 && text.front() == '[' && text.back() == ']';
    if (bracketed) {
        text = text.substr(1, text.size() - 2);
    }
    error_code failed;
    const auto address = boost::asio::ip::make_address(text, failed);
    if (failed || address.is_v6() != bracketed) {
        return std::nullopt;
    }
    return address;
}

}  // namespace

Result<tcp::endpoint, Problem> parse_endpoint(std::string_view text) {
    const auto colon = text.rfind(':');
    if (colon != std::string_view::npos) {
        const auto address = parse_address(text.substr(0, colon));
        const auto port = parse_port(text.substr(colon + 1));
        if (address && port) {
            return tcp::endpoint(*address, *port);
        }
    }
    return Problem{
        make_error_code(boost::system::errc::invalid_argument),
        fmt::format("\"{}\" is not an address to listen on", text),
        "write ADDRESS:PORT, for example 127.0.0.1:8080, 0.0.0.0:8080 or [::1]:8080"};
}

std::string to_text(const tcp::endpoint& endpoint) {
    const auto address = endpoint.address().to_string();
    return endpoint.address().is_v6() ? fmt::format("[{}]:{}", address, endpoint.port())
                                      : fmt::format("{}:{}", address, endpoint.port());
}

tcp::endpoint callable(const tcp::endpoint& endpoint) {
    if (!endpoint.address().is_unspecified()) {
        return endpoint;
    }
    using namespace boost::asio::ip;
    return {
        endpoint.address().is_v6() ? address(address_v6::loopback())
                                   : address(address_v4::loopback()),
        endpoint.port()};
}

}  // namespace sweepcast::net
