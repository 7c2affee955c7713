#include "driver/virtual/udp_port.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/system_error.hpp>

#include <algorithm>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace asio = boost::asio;
using asio::ip::udp;

UdpPort::UdpPort(udp::socket socket, std::string url)
    : socket_(std::move(socket))
    , url_(std::move(url)) {}

Result<std::unique_ptr<UdpPort>, Problem>
UdpPort::listen(const asio::any_io_executor& executor, const ListenAddress& address) {
    try {
        udp::socket socket(executor, udp::endpoint(address.address, address.port));
        socket.non_blocking(true);
        auto bound = address;
        bound.port = socket.local_endpoint().port();
        return std::unique_ptr<UdpPort>(new UdpPort(std::move(socket), to_url(bound)));
    } catch (const boost::system::system_error& failure) {
        return cannot_listen(address, failure.code());
    }
}

HostPort::Received UdpPort::read_some(std::span<std::uint8_t> into) {
    udp::endpoint sender;
    error_code failed;
    const auto count =
        socket_.receive_from(asio::buffer(into.data(), into.size()), sender, 0, failed);
    if (!failed) {
        host_ = sender;
    }
    return {.bytes = failed ? 0 : count, .host_present = host_.has_value()};
}

std::size_t UdpPort::write_some(std::span<const std::uint8_t> bytes) {
    std::size_t written = 0;
    while (host_ && written < bytes.size()) {
        const auto part = bytes.subspan(written, std::min(bytes.size() - written, max_datagram));
        error_code failed;
        const auto count =
            socket_.send_to(asio::buffer(part.data(), part.size()), *host_, 0, failed);
        if (failed) {
            break;
        }
        written += count;
    }
    return written;
}

asio::awaitable<void> UdpPort::news() {
    co_await socket_.async_wait(udp::socket::wait_read, asio::use_awaitable);
}

void UdpPort::clean_up_after_host(std::uint32_t /*baud*/) {}

void UdpPort::close() {
    error_code ignored;  // it is closed, whatever the system has to say to it
    socket_.close(ignored);
}

}  // namespace sweepcast::virtual_lidar
