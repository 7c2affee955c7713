// The one shape of the API's errors, and the table from the driver's errors to HTTP.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/api/request.hpp"

#include <string>

namespace sweepcast::api {

/// Returns {"error": {"code", "message", "hint"}} with this status. Message and hint may quote any
/// bytes: they are sent as protocol::printable() shows them.
[[nodiscard]] Response error_response(
    int status,
    const std::string& code,
    const std::string& message,
    const std::string& hint
);

/// The answer to a command that a lidar could not carry out.
[[nodiscard]] Response error_response(const Problem& problem);

/// 405: the path is there, but takes only the methods in `allowed`, e.g. "GET, HEAD".
[[nodiscard]] Response method_not_allowed(const Request& request, const std::string& allowed);

}  // namespace sweepcast::api
