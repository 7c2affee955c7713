// Requests: what a host says to a scanner, and how it looks on the line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sweepcast::protocol {

/// The first byte of every request and of every response descriptor (protocol.md 1.2, 1.3).
inline constexpr std::uint8_t start_byte = 0xA5;

/// The most payload a request can carry: its size is one byte.
inline constexpr std::size_t max_request_payload = 255;

/// Request codes (protocol.md 2). A scanner may be sent others: the value is not limited to these.
enum class Command : std::uint8_t {
    scan = 0x20,
    force_scan = 0x21,
    stop = 0x25,
    reset = 0x40,
    get_info = 0x50,
    get_health = 0x52,
    get_sample_rate = 0x59,
    express_scan = 0x82,
    hq_scan = 0x83,
    get_lidar_conf = 0x84,
    set_lidar_conf = 0x85,
    confirm_baud = 0x90,
    motor_rpm = 0xA8,
    set_motor_pwm = 0xF0,
    get_acc_board_flag = 0xFF,
};

/// Whether a request of this code carries size, payload and checksum: bit 7 decides
/// (protocol.md 1.2).
[[nodiscard]] constexpr bool carries_payload(Command command) {
    return (static_cast<std::uint8_t>(command) & 0x80U) != 0;
}

/// One request.
struct Request {
    Command command{};
    /// Empty for commands below 0x80; at most 255 bytes.
    std::vector<std::uint8_t> payload{};
    bool operator==(const Request&) const = default;
};

/// The bytes of a request: `A5 cmd`, or `A5 cmd n payload[n] xor` for commands from 0x80.
/// Throws std::logic_error for a payload over 255 bytes, or any payload on a command that carries
/// none: both are mistakes of the caller. Source: protocol.md 1.2.
[[nodiscard]] std::vector<std::uint8_t> encode(const Request& request);

/// Starts a stream in the scan mode with this id; 0 is legacy express. Source: protocol.md 2.
[[nodiscard]] Request express_scan_request(std::uint8_t working_mode);

/// Sets the duty of a motor behind an accessory board, 0..1023; 660 is usual, 0 stops it. Source:
/// protocol.md 5.
[[nodiscard]] Request set_motor_pwm_request(std::uint16_t pwm);

/// Sets the speed of a motor that regulates itself, in turns a minute; 0: idle. Source:
/// protocol.md 2, 5.
[[nodiscard]] Request motor_rpm_request(std::uint16_t rpm);

/// Asks whether an accessory board controls the motor. Source: protocol.md 2.
[[nodiscard]] Request acc_board_flag_request();

/// Makes a negotiated line speed last. Source: protocol.md 2, 4.7.
[[nodiscard]] Request confirm_baud_request(std::uint32_t baud);

/// The byte that a scanner measures the line speed by: sixteen of them, over and over, until it
/// answers with the speed as a bare 32-bit number. Source: protocol.md 4.7.
inline constexpr std::uint8_t autobaud_byte = 0x41;

}  // namespace sweepcast::protocol
