// RequestParser: finds requests in what a host sends. The scanner's side of the line, for the
// virtual lidar.
#pragma once

#include "driver/protocol/request.hpp"
#include "driver/protocol/units.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace sweepcast::protocol {

/// A request must be complete within this time from its first byte, else it is dropped
/// (protocol.md 1.2).
inline constexpr std::chrono::seconds request_time_limit{5};

/// Assembles requests from single bytes.
///
/// Anything before an A5 is skipped. A5 in the place of the command starts over: no command has
/// that value. A request whose checksum is wrong is dropped whole, but a wrong checksum byte of A5
/// starts the next one.
class RequestParser {
public:
    /// Takes the byte that arrived at `now` and gives the request that it completes, if any.
    /// Source: protocol.md 1.2.
    [[nodiscard]] std::optional<Request> push(std::uint8_t byte, SampleTime now);

private:
    enum class Waiting { start, command, size, payload, checksum };

    void begin(SampleTime now);
    void take_size(std::uint8_t byte);
    void take_payload(std::uint8_t byte);
    std::optional<Request> take_command(std::uint8_t byte, SampleTime now);
    std::optional<Request> take_checksum(std::uint8_t byte, SampleTime now);

    Waiting waiting_{Waiting::start};
    SampleTime started_{};
    Request request_{};
    std::size_t size_{};
    std::uint8_t checksum_{};
};

}  // namespace sweepcast::protocol
