#include "driver/link/network_link.hpp"

#include "driver/link/transport_link.hpp"

#include <boost/asio/buffer.hpp>

#include <algorithm>
#include <sys/socket.h>
#include <utility>
#include <vector>

namespace sweepcast::link {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::ip::udp;

namespace {

std::size_t receive_now(int socket, std::span<std::uint8_t> into) {
    const auto count = ::recv(socket, into.data(), into.size(), MSG_DONTWAIT);
    return count > 0 ? static_cast<std::size_t>(count) : 0;
}

/// What TCP and UDP have in common.
template <class Socket>
class SocketTransport {
public:
    explicit SocketTransport(Socket socket) : socket_(std::move(socket)) {}

    asio::any_io_executor executor() { return socket_.get_executor(); }
    [[nodiscard]] bool is_open() const { return socket_.is_open(); }
    void cancel() {
        error_code ignored;  // fails on a closed socket only, which has nothing pending
        socket_.cancel(ignored);
    }
    void close() {
        error_code ignored;  // the socket is gone even if closing reports an error
        socket_.close(ignored);
    }

protected:
    Socket& socket() { return socket_; }

private:
    Socket socket_;
};

class TcpTransport : public SocketTransport<tcp::socket> {
public:
    using SocketTransport::SocketTransport;

    asio::awaitable<Transferred> read_some(std::span<std::uint8_t> into) {
        return socket().async_read_some(asio::buffer(into.data(), into.size()), as_awaitable_tuple);
    }
    asio::awaitable<Transferred> write_some(std::span<const std::uint8_t> bytes) {
        return socket().async_write_some(
            asio::buffer(bytes.data(), bytes.size()),
            as_awaitable_tuple
        );
    }
    std::size_t read_now(std::span<std::uint8_t> into) {
        return receive_now(socket().native_handle(), into);
    }
};

/// A datagram is received whole, whatever the size asked for: the rest of one that is longer would
/// be lost otherwise.
class UdpTransport : public SocketTransport<udp::socket> {
public:
    explicit UdpTransport(udp::socket socket)
        : SocketTransport(std::move(socket))
        , datagram_(any_datagram) {}

    asio::awaitable<Transferred> read_some(std::span<std::uint8_t> into) {
        if (unread_ == 0) {
            const auto [ec, count] =
                co_await socket().async_receive(asio::buffer(datagram_), as_awaitable_tuple);
            if (ec) {
                co_return Transferred(ec, 0);
            }
            hold(count);
        }
        co_return Transferred(error_code(), take(into));
    }
    asio::awaitable<Transferred> write_some(std::span<const std::uint8_t> bytes) {
        const auto now = bytes.first(std::min(bytes.size(), longest_datagram));
        return socket().async_send(asio::buffer(now.data(), now.size()), as_awaitable_tuple);
    }
    std::size_t read_now(std::span<std::uint8_t> into) {
        if (unread_ == 0) {
            hold(receive_now(socket().native_handle(), datagram_));
        }
        return take(into);
    }

private:
    static constexpr std::size_t any_datagram = 65536;

    void hold(std::size_t count) {
        begin_ = 0;
        unread_ = count;
    }
    std::size_t take(std::span<std::uint8_t> into) {
        const std::size_t count = std::min(unread_, into.size());
        std::copy_n(datagram_.begin() + static_cast<std::ptrdiff_t>(begin_), count, into.begin());
        begin_ += count;
        unread_ -= count;
        return count;
    }

    std::vector<std::uint8_t> datagram_;
    std::size_t begin_{};
    std::size_t unread_{};
};

/// A network link has neither modem lines nor a speed.
template <Transport T>
class NetworkLink final : public TransportLink<T> {
public:
    using TransportLink<T>::TransportLink;

    Result<void> set_dtr(bool) override { return refuse(errc::no_modem_lines); }
    Result<void> set_baud(std::uint32_t) override { return refuse(errc::no_line_speed); }
    [[nodiscard]] std::uint32_t baud() const override { return 0; }
    [[nodiscard]] bool is_network() const override { return true; }

private:
    Result<void> refuse(errc why) {
        return error_code(this->transport().is_open() ? why : errc::disconnected);
    }
};

}  // namespace

std::unique_ptr<Link> make_tcp_link(tcp::socket socket) {
    error_code ignored;  // requests are then sent a little later
    socket.set_option(tcp::no_delay(true), ignored);
    return std::make_unique<NetworkLink<TcpTransport>>(TcpTransport(std::move(socket)));
}

std::unique_ptr<Link> make_udp_link(udp::socket socket) {
    return std::make_unique<NetworkLink<UdpTransport>>(UdpTransport(std::move(socket)));
}

}  // namespace sweepcast::link
