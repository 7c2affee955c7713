// Opens a serial port as a Link.
#pragma once

#include "driver/link/link.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <cstdint>
#include <memory>
#include <string>

namespace sweepcast::link {

/// Opens the serial port `path` (or a pty) for us alone, raw 8N1 without flow control, at `baud`
/// bits per second, any rate. Does not wait for anything.
///
/// Opening asserts DTR, as Linux does for every terminal: the motor of an A1 stops until
/// set_dtr(false). Closing leaves DTR as it is (HUPCL is cleared): otherwise the kernel would
/// release it and so start that motor. Sample times want bytes as they come, so the adapter is
/// asked for low latency.
///
/// Errors name the cause and the next step; codes: port_not_found, permission_denied, port_busy
/// (with the process that holds it), not_a_serial_port, baud_not_supported, io_error.
Result<std::unique_ptr<Link>, Problem> open_serial(
    const boost::asio::any_io_executor& executor,
    const std::string& path,
    std::uint32_t baud
);

}  // namespace sweepcast::link
