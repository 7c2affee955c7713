// Messages over TCP, each with its length in front as a varint.
#pragma once

#include "server/stream/transport.hpp"

#include <boost/asio/ip/tcp.hpp>

#include <memory>

namespace sweepcast::stream {

/// Takes the socket over and sets its options: bounded kernel buffer, no delay, dead peers noticed.
[[nodiscard]] std::unique_ptr<Transport> make_tcp_transport(boost::asio::ip::tcp::socket socket);

/// Options for any stream socket: small sends leave at once; at most `kernel_send_buffer` bytes
/// wait in the kernel for a client that does not read; a peer that is gone, or takes nothing for
/// `stall_limit`, is cut off by the kernel.
void set_stream_options(boost::asio::ip::tcp::socket& socket);

}  // namespace sweepcast::stream
