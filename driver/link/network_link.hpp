// Links over the network: TCP (a scanner behind a serial bridge) and UDP (a scanner with a network
// port of its own).
#pragma once

#include "driver/link/link.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>

#include <cstddef>
#include <memory>

namespace sweepcast::link {

/// Scanners and the vendor's SDK take no more in one datagram (protocol.md 1.1).
inline constexpr std::size_t longest_datagram = 1024;

/// Takes over a connected socket and sends small requests at once (TCP_NODELAY).
std::unique_ptr<Link> make_tcp_link(boost::asio::ip::tcp::socket socket);

/// Takes over a connected socket. What is written goes out in datagrams of at most
/// longest_datagram; those that come are read as one stream of bytes, for their borders carry no
/// meaning (protocol.md 1.1). That the host has nobody at the port counts as errc::disconnected; it
/// can only be noticed after something was written.
std::unique_ptr<Link> make_udp_link(boost::asio::ip::udp::socket socket);

}  // namespace sweepcast::link
