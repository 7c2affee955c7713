#include "server/api/errors.hpp"

#include "driver/device/error.hpp"
#include "driver/protocol/printable.hpp"
#include "server/api/json.hpp"
#include "sweepcast/v1/api.pb.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace sweepcast::api {

namespace {

struct Mapping {
    device::errc from;
    int status;
    const char* code;
};

constexpr std::array mappings{
    Mapping{device::errc::unknown_mode, 400, "unknown_mode"},
    Mapping{device::errc::no_such_speed, 400, "no_such_speed"},
    Mapping{device::errc::fixed_speed, 409, "fixed_speed"},
    Mapping{device::errc::not_ready, 503, "lidar_not_ready"},
    Mapping{device::errc::superseded, 409, "superseded"},
    Mapping{device::errc::shutting_down, 503, "shutting_down"},
};

}  // namespace

Response error_response(
    int status,
    const std::string& code,
    const std::string& message,
    const std::string& hint
) {
    v1::ErrorResponse response;
    response.mutable_error()->set_code(code);
    response.mutable_error()->set_message(protocol::printable(message));
    response.mutable_error()->set_hint(protocol::printable(hint));
    return {status, "application/json", to_json(response), {}};
}

Response method_not_allowed(const Request& request, const std::string& allowed) {
    auto response = error_response(
        405,
        "method_not_allowed",
        fmt::format("{} does not work on {}", request.method, request.path),
        "use " + allowed
    );
    response.headers.emplace_back("Allow", allowed);
    return response;
}

Response error_response(const Problem& problem) {
    if (problem.code == boost::system::errc::operation_not_supported) {
        return error_response(409, "controlled_elsewhere", problem.cause, problem.hint);
    }
    const auto* known = std::ranges::find_if(mappings, [&](const Mapping& mapping) {
        return problem.code == mapping.from;
    });
    return known != mappings.end()
               ? error_response(known->status, known->code, problem.cause, problem.hint)
               : error_response(503, "lidar_failed", problem.cause, problem.hint);
}

}  // namespace sweepcast::api
