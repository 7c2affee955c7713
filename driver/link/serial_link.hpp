// Opens a serial port as a Link.
#pragma once

#include "driver/link/link.hpp"
#include "driver/link/owned_descriptor.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <memory>
#include <string>

namespace sweepcast::link {

/// Opens the serial port `path` (or a pty) for us alone, raw 8N1 without flow control, at `baud`
/// bits per second, any rate. Some drivers have one wait, and what is said of a port that cannot be
/// opened is looked for in all of /proc: that is done on another thread (see async::run_blocking;
/// the lane is the device file), and given up at `deadline`.
///
/// Opening asserts DTR, as Linux does for every terminal: the motor of an A1 stops until
/// set_dtr(false). So a port that another process is seen to have open is not opened at all.
/// Closing leaves DTR as it is (HUPCL is cleared): otherwise the kernel would release it and so
/// start that motor. Sample times want bytes as they come, so the adapter is asked for low latency.
/// A port whose device file vanishes closes itself.
///
/// Errors name the cause and the next step; codes: port_not_found, permission_denied, port_busy
/// (with the process that holds it), not_a_serial_port, baud_not_supported, io_error, timed_out.
/// Throws boost::system::system_error (operation_aborted) if the coroutine is cancelled meanwhile.
boost::asio::awaitable<Result<std::unique_ptr<Link>, Problem>> open_serial(
    boost::asio::any_io_executor executor,
    std::string path,
    std::uint32_t baud,
    Deadline deadline
);

/// As open_serial(), but on this thread, which waits.
Result<std::unique_ptr<Link>, Problem> open_serial_now(
    const boost::asio::any_io_executor& executor,
    const std::string& path,
    std::uint32_t baud
);

}  // namespace sweepcast::link
