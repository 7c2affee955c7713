// Requests -> bytes.
#include "driver/protocol/request.hpp"

#include "driver/protocol/wire.hpp"

#include <array>
#include <stdexcept>

namespace sweepcast::protocol {

std::vector<std::uint8_t> encode(const Request& request) {
    const auto size = request.payload.size();
    if (size > (carries_payload(request.command) ? max_request_payload : 0)) {
        throw std::logic_error("a request's payload is longer than its command can carry");
    }
    std::vector<std::uint8_t> bytes;
    bytes.reserve(size + 4);
    bytes.push_back(start_byte);
    bytes.push_back(static_cast<std::uint8_t>(request.command));
    if (carries_payload(request.command)) {
        bytes.push_back(static_cast<std::uint8_t>(size));
        bytes.insert(bytes.end(), request.payload.begin(), request.payload.end());
        bytes.push_back(xor_checksum(bytes));
    }
    return bytes;
}

Request express_scan_request(std::uint8_t working_mode) {
    // Flags and parameter (two words) are zero: nothing is known to send anything else.
    return {Command::express_scan, {working_mode, 0, 0, 0, 0}};
}

Request set_motor_pwm_request(std::uint16_t pwm) {
    std::array<std::uint8_t, 2> payload{};
    store_le16(payload, pwm);
    return {Command::set_motor_pwm, {payload.begin(), payload.end()}};
}

Request motor_rpm_request(std::uint16_t rpm) {
    std::array<std::uint8_t, 2> payload{};
    store_le16(payload, rpm);
    return {Command::motor_rpm, {payload.begin(), payload.end()}};
}

Request acc_board_flag_request() {
    return {Command::get_acc_board_flag, {0, 0, 0, 0}};
}

Request confirm_baud_request(std::uint32_t baud) {
    std::array<std::uint8_t, 8> payload{0x5F, 0x5F};
    store_le32(std::span(payload).subspan<2, 4>(), baud);
    return {Command::confirm_baud, {payload.begin(), payload.end()}};
}

}  // namespace sweepcast::protocol
