#include "driver/virtual/tcp_port.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/system_error.hpp>

#include <chrono>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace asio = boost::asio;
using asio::ip::tcp;

TcpPort::TcpPort(tcp::acceptor acceptor, std::string url)
    : acceptor_(std::move(acceptor))
    , next_try_(acceptor_.get_executor())
    , url_(std::move(url)) {}

Result<std::unique_ptr<TcpPort>, Problem>
TcpPort::listen(const asio::any_io_executor& executor, const ListenAddress& address) {
    try {
        tcp::acceptor acceptor(executor, tcp::endpoint(address.address, address.port));
        acceptor.non_blocking(true);
        auto bound = address;
        bound.port = acceptor.local_endpoint().port();
        return std::unique_ptr<TcpPort>(new TcpPort(std::move(acceptor), to_url(bound)));
    } catch (const boost::system::system_error& failure) {
        return cannot_listen(address, failure.code());
    }
}

bool TcpPort::accept() {
    error_code failed;
    auto socket = acceptor_.accept(failed);
    accept_failed_ = failed && failed != asio::error::would_block;
    if (failed) {
        return false;
    }
    socket.non_blocking(true, failed);
    error_code ignored;  // without it data comes later, but it comes
    socket.set_option(tcp::no_delay(true), ignored);
    if (!failed) {
        host_.emplace(std::move(socket));
    }
    return !failed;
}

HostPort::Received TcpPort::read_some(std::span<std::uint8_t> into) {
    if (!host_ && !accept()) {
        return {};
    }
    error_code failed;
    const auto count = host_->read_some(asio::buffer(into.data(), into.size()), failed);
    if (failed && failed != asio::error::would_block) {
        host_.reset();
    }
    return {.bytes = count, .host_present = host_.has_value()};
}

std::size_t TcpPort::write_some(std::span<const std::uint8_t> bytes) {
    std::size_t written = 0;
    error_code failed;  // reading tells what it is
    while (host_ && !failed && written < bytes.size()) {
        const auto rest = bytes.subspan(written);
        written += host_->write_some(asio::buffer(rest.data(), rest.size()), failed);
    }
    return written;
}

asio::awaitable<void> TcpPort::news() {
    if (host_) {
        co_await host_->async_wait(tcp::socket::wait_read, asio::use_awaitable);
    } else if (accept_failed_) {
        // For want of descriptors, mostly: the connection still waits, so the acceptor stays ready.
        constexpr auto pause = std::chrono::milliseconds(100);
        next_try_.expires_after(pause);
        co_await next_try_.async_wait(asio::use_awaitable);
    } else {
        co_await acceptor_.async_wait(tcp::acceptor::wait_read, asio::use_awaitable);
    }
}

// Each connection has its own buffers.
void TcpPort::clean_up_after_host(std::uint32_t /*baud*/) {}

void TcpPort::close() {
    error_code ignored;  // they are closed, whatever the system has to say to it
    if (host_) {
        host_->close(ignored);
    }
    acceptor_.close(ignored);
    next_try_.cancel();
}

}  // namespace sweepcast::virtual_lidar
