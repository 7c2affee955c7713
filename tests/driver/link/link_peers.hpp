// The far ends of links of each kind, held by the test as a device would.
#pragma once

#include "driver/link/network_link.hpp"
#include "driver/link/serial_link.hpp"
#include "tests/driver/link/pty_pair.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>

#include <cstdint>
#include <memory>
#include <poll.h>
#include <span>
#include <stdexcept>
#include <sys/socket.h>
#include <vector>

namespace sweepcast::link {

class PtyPeer {
public:
    static constexpr bool is_network = false;
    /// A write of so much cannot be finished while nobody reads.
    static constexpr std::size_t more_than_fits = 1 << 16;

    std::unique_ptr<Link> make_link(boost::asio::io_context& context) const {
        auto opened = open_serial_now(context.get_executor(), pty_.path(), 115200);
        if (!opened) {
            throw std::runtime_error(opened.error().cause);
        }
        return std::move(*opened);
    }
    void send(std::span<const std::uint8_t> bytes) { pty_.send(bytes); }
    /// Waits for the first of up to `most` bytes, at most ten seconds.
    [[nodiscard]] std::vector<std::uint8_t> receive(std::size_t most) { return pty_.receive(most); }
    void hang_up() { pty_.hang_up(); }
    [[nodiscard]] const std::string& path() const { return pty_.path(); }
    [[nodiscard]] int fd() const { return pty_.fd(); }

private:
    PtyPair pty_;
};

/// What was received on a socket; waits for the first bytes, at most ten seconds.
inline std::vector<std::uint8_t> receive_from(int socket, std::size_t most) {
    pollfd waiting{socket, POLLIN, 0};
    if (::poll(&waiting, 1, 10'000) != 1) {
        throw std::runtime_error("nothing came out of a socket");
    }
    std::vector<std::uint8_t> bytes(most);
    const auto count = ::recv(socket, bytes.data(), bytes.size(), 0);
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return bytes;
}

inline void send_whole(int socket, std::span<const std::uint8_t> bytes) {
    if (::send(socket, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
        throw std::runtime_error("short write to a socket");
    }
}

class TcpPeer {
    using tcp = boost::asio::ip::tcp;

public:
    static constexpr bool is_network = true;
    static constexpr std::size_t more_than_fits = 1 << 23;  // loopback's buffers grow to megabytes

    std::unique_ptr<Link> make_link(boost::asio::io_context& context) {
        tcp::acceptor acceptor(own_, {boost::asio::ip::address_v4::loopback(), 0});
        tcp::socket socket(context);
        socket.connect(acceptor.local_endpoint());
        acceptor.accept(socket_);
        return make_tcp_link(std::move(socket));
    }
    void send(std::span<const std::uint8_t> bytes) { send_whole(socket_.native_handle(), bytes); }
    [[nodiscard]] std::vector<std::uint8_t> receive(std::size_t most) {
        return receive_from(socket_.native_handle(), most);
    }
    void hang_up() { socket_.close(); }

private:
    boost::asio::io_context own_;
    tcp::socket socket_{own_};
};

class UdpPeer {
    using udp = boost::asio::ip::udp;

public:
    static constexpr bool is_network = true;

    std::unique_ptr<Link> make_link(boost::asio::io_context& context) {
        const udp::endpoint any(boost::asio::ip::address_v4::loopback(), 0);
        udp::socket socket(context, any);
        socket_ = udp::socket(own_, any);
        socket.connect(socket_.local_endpoint());
        socket_.connect(socket.local_endpoint());
        return make_udp_link(std::move(socket));
    }
    /// One datagram.
    void send(std::span<const std::uint8_t> bytes) { send_whole(socket_.native_handle(), bytes); }
    /// One datagram.
    [[nodiscard]] std::vector<std::uint8_t> receive(std::size_t most) {
        return receive_from(socket_.native_handle(), most);
    }
    void hang_up() { socket_.close(); }
    [[nodiscard]] udp::endpoint link_endpoint() const { return socket_.remote_endpoint(); }

private:
    boost::asio::io_context own_;
    udp::socket socket_{own_};
};

}  // namespace sweepcast::link
