// UdpPort: a scanner with Ethernet of its own.
#pragma once

#include "driver/protocol/result.hpp"
#include "driver/virtual/host_port.hpp"
#include "driver/virtual/listen_address.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/udp.hpp>

#include <memory>
#include <optional>
#include <string>

namespace sweepcast::virtual_lidar {

/// The host is whoever sent the last datagram. Nothing tells when it has gone.
class UdpPort final : public HostPort {
public:
    /// What one datagram holds at most: the vendor's SDK reads no more (protocol.md 1.1).
    static constexpr std::size_t max_datagram = 1024;

    /// Errors: errc::port_unavailable.
    static Result<std::unique_ptr<UdpPort>, Problem>
    listen(const boost::asio::any_io_executor& executor, const ListenAddress& address);

    [[nodiscard]] const std::string& address() const override { return url_; }
    Received read_some(std::span<std::uint8_t> into) override;
    std::size_t write_some(std::span<const std::uint8_t> bytes) override;
    boost::asio::awaitable<void> news() override;
    void clean_up_after_host(std::uint32_t baud) override;
    void close() override;
    [[nodiscard]] std::uint32_t host_baud() const override { return 0; }

private:
    UdpPort(boost::asio::ip::udp::socket socket, std::string url);

    boost::asio::ip::udp::socket socket_;
    std::optional<boost::asio::ip::udp::endpoint> host_;
    std::string url_;
};

}  // namespace sweepcast::virtual_lidar
