// Where a device is, as users write it: a serial port, or a host on the network.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sweepcast::link {

/// A serial port, or anything that behaves as one.
struct SerialPlace {
    std::string path;
    std::optional<std::uint32_t> baud;  ///< bits per second; none: to be found out
    bool operator==(const SerialPlace&) const = default;
};

/// A scanner behind a serial bridge.
struct TcpPlace {
    std::string host;  ///< name or address; IPv6 without brackets
    std::uint16_t port{};
    bool operator==(const TcpPlace&) const = default;
};

/// A scanner with a network port of its own.
struct UdpPlace {
    std::string host;  ///< name or address; IPv6 without brackets
    std::uint16_t port{};
    bool operator==(const UdpPlace&) const = default;
};

struct LinkUrl {
    std::string text;  ///< as the user wrote it
    std::variant<SerialPlace, TcpPlace, UdpPlace> where;
};

/// A parameter after the '?' of a URL, decoded.
struct UrlParameter {
    std::string key;
    std::string value;
    bool operator==(const UrlParameter&) const = default;
};

/// What a bridge of Slamtec's listens on (protocol.md 1.1).
inline constexpr std::uint16_t default_tcp_port = 20108;
/// What a T1 or S2E listens on (protocol.md 6).
inline constexpr std::uint16_t default_udp_port = 8089;
/// Speeds that a user may name, in bits per second.
inline constexpr std::uint32_t lowest_baud = 1200;
inline constexpr std::uint32_t highest_baud = 12'000'000;

/// Reads "/dev/ttyUSB0", "/dev/ttyUSB0?baud=256000", "serial:/dev/ttyUSB0?baud=256000",
/// "tcp://host:20108", "udp://host:8089"; ports may be left out, IPv6 addresses stand in brackets.
/// A text without a scheme is a path, taken as it stands up to the first '?'.
/// The Problem names what is wrong and shows what can be written.
[[nodiscard]] Result<LinkUrl, Problem> parse_link_url(std::string_view text);

/// As parse_link_url(text), but parameters that are not the link's own go to `others`, in their
/// order, instead of being refused.
[[nodiscard]] Result<LinkUrl, Problem>
parse_link_url(std::string_view text, std::vector<UrlParameter>& others);

/// A short name for where it is: the last part of a port's path ("ttyUSB0"), or the host.
[[nodiscard]] std::string short_name(const LinkUrl& url);

}  // namespace sweepcast::link
