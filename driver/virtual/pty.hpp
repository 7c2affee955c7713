// Pty: the pseudo terminal that a host opens as if it were the scanner's serial port.
#pragma once

#include "driver/protocol/result.hpp"
#include "driver/virtual/host_port.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace sweepcast::virtual_lidar {

/// Our end of a pseudo terminal. Hosts may open and close the other end as often as they like; no
/// end of it is kept open here, so that it is known whether a host is there.
class Pty final : public HostPort {
public:
    /// Opens a new pair. The host's end is raw (no echo, every byte as it is), open to this user
    /// only, and set to `baud`, for hosts that do not set a speed. Errors: errc::port_unavailable.
    static Result<std::unique_ptr<Pty>, Problem>
    open(const boost::asio::any_io_executor& executor, std::uint32_t baud);

    [[nodiscard]] const std::string& address() const override { return path_; }
    Received read_some(std::span<std::uint8_t> into) override;
    std::size_t write_some(std::span<const std::uint8_t> bytes) override;
    boost::asio::awaitable<void> news() override;
    void clean_up_after_host(std::uint32_t baud) override;
    void close() override;
    [[nodiscard]] std::uint32_t host_baud() const override;

private:
    Pty(boost::asio::posix::stream_descriptor descriptor, std::string path);

    // Stream descriptors take operations on a const object for none of those that they allow.
    mutable boost::asio::posix::stream_descriptor descriptor_;
    boost::asio::steady_timer next_look_;
    std::string path_;
    bool host_present_{};
};

}  // namespace sweepcast::virtual_lidar
