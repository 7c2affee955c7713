// Opens whatever a LinkUrl names.
#pragma once

#include "driver/link/link.hpp"
#include "driver/link/link_url.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <memory>

namespace sweepcast::link {

/// How long opening a port, or finding a host and connecting to it, may take in all, unless told
/// otherwise.
inline constexpr std::chrono::milliseconds connect_limit{3000};

/// Opens a serial port at `baud` bits per second (see open_serial; the speed in the URL is the
/// caller's to choose), or connects to a host, for which `baud` means nothing. UDP only finds the
/// host: whether a scanner is there shows when it is asked.
/// The Problem says what is wrong and what to do; codes: those of open_serial, host_not_found,
/// connection_refused, unreachable, timed_out, or else the system's own.
/// Throws boost::system::system_error (operation_aborted) if the coroutine is cancelled meanwhile.
boost::asio::awaitable<Result<std::unique_ptr<Link>, Problem>> open_link(
    boost::asio::any_io_executor executor,
    LinkUrl url,
    std::uint32_t baud,
    std::chrono::milliseconds limit = connect_limit
);

/// Explains why connecting to `host`, `port` by "tcp" or "udp" failed. Pure.
Problem explain_connect_error(
    const std::string& scheme,
    const std::string& host,
    std::uint16_t port,
    const error_code& error
);

}  // namespace sweepcast::link
