// Pty: the pseudo terminal that a host opens as if it were the scanner's serial port.
#pragma once

#include "driver/protocol/result.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace sweepcast::virtual_lidar {

/// Our end of a pseudo terminal. Hosts may open and close the other end as often as they like; no
/// end of it is kept open here, so that it is known whether a host is there.
class Pty {
public:
    /// Opens a new pair. The host's end is raw (no echo, every byte as it is) and open to this user
    /// only. Errors: errc::port_unavailable.
    static Result<Pty, Problem> open(const boost::asio::any_io_executor& executor);

    /// The path of the host's end, e.g. /dev/pts/5.
    [[nodiscard]] const std::string& port() const { return port_; }

    struct Received {
        std::size_t bytes{};
        bool host_present{};
    };

    /// Reads what the host has written, without waiting.
    Received read_some(std::span<std::uint8_t> into);

    /// Writes to the host without waiting. Returns how many bytes the system took: fewer than given
    /// if the host does not read.
    std::size_t write_some(std::span<const std::uint8_t> bytes);

    /// Waits until there is something to read or the host has closed its end.
    boost::asio::awaitable<void> readable();

    /// To be called when a host has gone: what it left unread and how it set up the line is not for
    /// the next one.
    void clean_up_after_host();

private:
    Pty(boost::asio::posix::stream_descriptor descriptor, std::string port);

    boost::asio::posix::stream_descriptor descriptor_;
    std::string port_;
};

}  // namespace sweepcast::virtual_lidar
