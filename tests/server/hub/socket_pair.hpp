// Two connected sockets within the process, as a client and its gateway have them.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <array>
#include <stdexcept>
#include <sys/socket.h>
#include <utility>

namespace sweepcast::hub {

/// The client's end, which does not block, and the gateway's. The kernel holds little in between,
/// so that soon no more can be sent to a client that does not read.
inline std::pair<boost::asio::ip::tcp::socket, boost::asio::ip::tcp::socket> socket_pair(
    const boost::asio::any_io_executor& clients,
    const boost::asio::any_io_executor& gateways
) {
    using boost::asio::ip::tcp;
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) {
        throw std::runtime_error("no pair of sockets");
    }
    tcp::socket client(clients, tcp::v4(), ends[0]);
    tcp::socket gateway(gateways, tcp::v4(), ends[1]);
    client.non_blocking(true);
    gateway.set_option(boost::asio::socket_base::send_buffer_size(1));
    return {std::move(client), std::move(gateway)};
}

/// Both on one executor.
inline std::pair<boost::asio::ip::tcp::socket, boost::asio::ip::tcp::socket> socket_pair(
    const boost::asio::any_io_executor& executor
) {
    return socket_pair(executor, executor);
}

}  // namespace sweepcast::hub
