#include "driver/virtual/listen_address.hpp"

#include "driver/virtual/error.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <system_error>

namespace sweepcast::virtual_lidar {

namespace {

namespace ip = boost::asio::ip;

std::optional<ip::address> parse_address(std::string_view text) {
    if (text == "localhost") {
        return ip::address_v4::loopback();
    }
    const bool bracketed = text.size() >= 2 && text.front() == '[' && text.back() == ']';
    if (bracketed) {
        text = text.substr(1, text.size() - 2);
    }
    error_code failed;
    const auto address = ip::make_address(text, failed);
    return failed || address.is_v6() != bracketed ? std::nullopt : std::optional(address);
}

std::optional<std::uint16_t> parse_port(std::string_view text) {
    std::uint16_t port = 0;
    const auto* const end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(text.data(), end, port);
    return failure == std::errc{} && stop == end ? std::optional(port) : std::nullopt;
}

}  // namespace

Result<ListenAddress, Problem> parse_listen_address(std::string_view text, Connection connection) {
    constexpr std::string_view tcp = "tcp://";
    constexpr std::string_view udp = "udp://";
    auto rest = text;
    auto transport = connection == Connection::ethernet ? Transport::udp : Transport::tcp;
    if (text.starts_with(tcp) || text.starts_with(udp)) {
        transport = text.starts_with(tcp) ? Transport::tcp : Transport::udp;
        rest.remove_prefix(tcp.size());
    }
    const auto colon = rest.rfind(':');
    if (colon != std::string_view::npos) {
        const auto address = parse_address(rest.substr(0, colon));
        const auto port = parse_port(rest.substr(colon + 1));
        if (address && port) {
            return ListenAddress{transport, *address, *port};
        }
    }
    return Problem{
        errc::invalid_option,
        fmt::format("\"{}\" is not an address to listen on", text),
        "write for example tcp://127.0.0.1:20108, udp://127.0.0.1:8089 or 127.0.0.1:0"};
}

std::string to_url(const ListenAddress& address) {
    const auto text = address.address.to_string();
    return fmt::format(
        "{}://{}:{}",
        address.transport == Transport::tcp ? "tcp" : "udp",
        address.address.is_v6() ? "[" + text + "]" : text,
        address.port
    );
}

Problem cannot_listen(const ListenAddress& address, const error_code& why) {
    return {
        errc::port_unavailable,
        fmt::format("cannot listen on {}: {}", to_url(address), why.message()),
        "choose an address of this machine and a port that is free; port 0 takes any"};
}

}  // namespace sweepcast::virtual_lidar
