// HostPort: where the host of a virtual lidar is: on a pseudo terminal, or on a network.
#pragma once

#include <boost/asio/awaitable.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace sweepcast::virtual_lidar {

class HostPort {
public:
    virtual ~HostPort() = default;

    /// What a host opens: /dev/pts/5, tcp://127.0.0.1:20108 or udp://127.0.0.1:8089.
    [[nodiscard]] virtual const std::string& address() const = 0;

    struct Received {
        std::size_t bytes{};
        bool host_present{};
    };

    /// Reads what the host has written, without waiting.
    virtual Received read_some(std::span<std::uint8_t> into) = 0;

    /// Writes to the host without waiting. Returns how many bytes the system took: fewer than given
    /// if the host does not read.
    virtual std::size_t write_some(std::span<const std::uint8_t> bytes) = 0;

    /// Waits until read_some() may bring something new: bytes, a host, or that it has gone.
    virtual boost::asio::awaitable<void> news() = 0;

    /// To be called when a host has gone: what it left unread and how it set up the line is not for
    /// the next one. `baud` is the speed that the scanner speaks.
    virtual void clean_up_after_host(std::uint32_t baud) = 0;

    /// Takes the port from its host at once, as pulling the cable does. Ends news() with
    /// operation_aborted. Nothing else is called after it.
    virtual void close() = 0;

    /// The bits a second that the host has set; 0 where there is no such thing.
    [[nodiscard]] virtual std::uint32_t host_baud() const = 0;
};

}  // namespace sweepcast::virtual_lidar
