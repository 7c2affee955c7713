#include "tests/e2e/relay.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>

#include <array>
#include <poll.h>
#include <span>
#include <stdexcept>
#include <sys/socket.h>
#include <unistd.h>

namespace sweepcast::test {

namespace {

namespace asio = boost::asio;
namespace ip = boost::asio::ip;

void check(bool is_well, const char* what) {
    if (!is_well) {
        throw std::runtime_error(std::string("relay: ") + what);
    }
}

/// A socket bound to a port of its own on this machine, and that port.
std::pair<int, std::uint16_t> bound_socket(int type) {
    const int socket = ::socket(AF_INET, type | SOCK_CLOEXEC, 0);
    ip::tcp::endpoint any(ip::address_v4::loopback(), 0);
    auto size = static_cast<socklen_t>(any.size());
    check(socket >= 0 && ::bind(socket, any.data(), size) == 0, "no port");
    check(::getsockname(socket, any.data(), &size) == 0, "no name");
    return {socket, any.port()};
}

}  // namespace

Relay::Relay(const std::string& lidar) : is_udp_(lidar.starts_with("udp://")) {
    const int type = is_udp_ ? SOCK_DGRAM : SOCK_STREAM;
    const auto port = static_cast<std::uint16_t>(std::stoi(lidar.substr(lidar.rfind(':') + 1)));
    const ip::tcp::endpoint target(ip::address_v4::loopback(), port);
    device_ = ::socket(AF_INET, type | SOCK_CLOEXEC, 0);
    check(
        ::connect(device_, target.data(), static_cast<socklen_t>(target.size())) == 0,
        "no lidar"
    );
    const auto [listener, own_port] = bound_socket(type);
    listener_ = listener;
    check(is_udp_ || ::listen(listener_, 1) == 0, "cannot listen");
    check(::pipe(wake_) == 0, "no pipe");
    url_ = lidar.substr(0, 6) + "127.0.0.1:" + std::to_string(own_port);
    thread_ = std::thread([this] { run(); });
}

Relay::~Relay() {
    finish();
    for (const int descriptor : {listener_, device_, wake_[0], wake_[1]}) {
        ::close(descriptor);
    }
}

Relay::Passed Relay::finish() {
    if (thread_.joinable()) {
        (void)::write(wake_[1], "", 1);
        thread_.join();
    }
    return passed_;
}

void Relay::run() {
    std::array<pollfd, 3> waiting{
        pollfd{listener_, POLLIN, 0},
        pollfd{wake_[0], POLLIN, 0},
        pollfd{-1, POLLIN, 0}};
    auto& [host, wake, device] = waiting;
    int accepted = -1;
    while (::poll(waiting.data(), waiting.size(), -1) > 0 && wake.revents == 0) {
        if (host.revents != 0 && !is_udp_ && accepted < 0) {
            accepted = ::accept(listener_, nullptr, nullptr);
            host.fd = accepted;
            device.fd = device_;
            continue;
        }
        if (host.revents != 0 && is_udp_ && device.fd < 0) {
            std::array<std::uint8_t, 1> peeked{};
            ip::udp::endpoint from;
            auto size = static_cast<socklen_t>(from.capacity());
            ::recvfrom(listener_, peeked.data(), peeked.size(), MSG_PEEK, from.data(), &size);
            ::connect(listener_, from.data(), size);
            device.fd = device_;
        }
        if (host.revents != 0 && !pass(host.fd, device_, passed_.to_device)) {
            break;
        }
        if (device.revents != 0 && !pass(device_, host.fd, passed_.from_device)) {
            break;
        }
    }
    if (accepted >= 0) {
        ::close(accepted);
    }
}

/// False at the end of the connection.
bool Relay::pass(int from, int to, std::vector<std::uint8_t>& kept) {
    std::array<std::uint8_t, 4096> bytes{};
    const auto count = ::recv(from, bytes.data(), bytes.size(), 0);
    if (count <= 0) {
        return false;
    }
    const auto passed = std::span(bytes).first(static_cast<std::size_t>(count));
    kept.insert(kept.end(), passed.begin(), passed.end());
    return ::send(to, passed.data(), passed.size(), MSG_NOSIGNAL) == count;
}

}  // namespace sweepcast::test
