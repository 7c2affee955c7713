// Where a virtual lidar on a network listens, as users write it.
#pragma once

#include "driver/protocol/result.hpp"
#include "driver/virtual/persona.hpp"

#include <boost/asio/ip/address.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace sweepcast::virtual_lidar {

enum class Transport : std::uint8_t { tcp, udp };

struct ListenAddress {
    Transport transport{};
    boost::asio::ip::address address{};
    std::uint16_t port{};  ///< 0: the system chooses
    bool operator==(const ListenAddress&) const = default;
};

/// Reads "tcp://127.0.0.1:20108", "udp://[::1]:8089", or "127.0.0.1:0", which is UDP for a scanner
/// that has Ethernet and TCP, as behind a serial bridge, for one that has not.
/// Errors: errc::invalid_option.
[[nodiscard]] Result<ListenAddress, Problem>
parse_listen_address(std::string_view text, Connection connection);

/// The same as a URL.
[[nodiscard]] std::string to_url(const ListenAddress& address);

/// What a user should know if `address` cannot be had.
[[nodiscard]] Problem cannot_listen(const ListenAddress& address, const error_code& why);

}  // namespace sweepcast::virtual_lidar
