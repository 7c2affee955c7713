// TcpPort: a scanner behind a serial bridge, for hosts on the network.
#pragma once

#include "driver/protocol/result.hpp"
#include "driver/virtual/host_port.hpp"
#include "driver/virtual/listen_address.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include <memory>
#include <optional>
#include <string>

namespace sweepcast::virtual_lidar {

/// Serves one connection at a time; the next one waits until it has ended.
class TcpPort final : public HostPort {
public:
    /// Errors: errc::port_unavailable.
    static Result<std::unique_ptr<TcpPort>, Problem>
    listen(const boost::asio::any_io_executor& executor, const ListenAddress& address);

    [[nodiscard]] const std::string& address() const override { return url_; }
    Received read_some(std::span<std::uint8_t> into) override;
    std::size_t write_some(std::span<const std::uint8_t> bytes) override;
    boost::asio::awaitable<void> news() override;
    void clean_up_after_host(std::uint32_t baud) override;
    void close() override;
    [[nodiscard]] std::uint32_t host_baud() const override { return 0; }

private:
    TcpPort(boost::asio::ip::tcp::acceptor acceptor, std::string url);
    bool accept();

    boost::asio::ip::tcp::acceptor acceptor_;
    boost::asio::steady_timer next_try_;
    bool accept_failed_{};
    std::optional<boost::asio::ip::tcp::socket> host_;
    std::string url_;
};

}  // namespace sweepcast::virtual_lidar
