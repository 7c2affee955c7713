// Replies of one packet, both ways, and the names made from them.
#include "driver/protocol/reply.hpp"

#include "driver/protocol/error.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>
#include <string_view>

namespace sweepcast::protocol {
namespace {

std::uint16_t to_word(std::chrono::microseconds duration) {
    return static_cast<std::uint16_t>(std::clamp<std::int64_t>(duration.count(), 0, 0xFFFF));
}

}  // namespace

Result<DeviceInfo> decode_device_info(std::span<const std::uint8_t> packet) {
    if (packet.size() != device_info_size) {
        return make_error_code(errc::length_out_of_range);
    }
    DeviceInfo info{
        .model = packet[0],
        .firmware_major = packet[2],
        .firmware_minor = packet[1],
        .hardware = packet[3]};
    std::copy_n(packet.begin() + 4, info.serial.size(), info.serial.begin());
    return info;
}

std::array<std::uint8_t, device_info_size> encode_device_info(const DeviceInfo& info) {
    std::array<std::uint8_t, device_info_size> packet{
        info.model,
        info.firmware_minor,
        info.firmware_major,
        info.hardware};
    std::copy(info.serial.begin(), info.serial.end(), packet.begin() + 4);
    return packet;
}

Result<Health> decode_health(std::span<const std::uint8_t> packet) {
    if (packet.size() != health_size) {
        return make_error_code(errc::length_out_of_range);
    }
    if (packet[0] > static_cast<std::uint8_t>(HealthStatus::error)) {
        return make_error_code(errc::malformed_reply);
    }
    return Health{static_cast<HealthStatus>(packet[0]), load_le16(packet.subspan<1, 2>())};
}

std::array<std::uint8_t, health_size> encode_health(const Health& health) {
    std::array<std::uint8_t, health_size> packet{static_cast<std::uint8_t>(health.status)};
    store_le16(std::span(packet).subspan<1, 2>(), health.code);
    return packet;
}

Result<SampleRate> decode_sample_rate(std::span<const std::uint8_t> packet) {
    if (packet.size() != sample_rate_size) {
        return make_error_code(errc::length_out_of_range);
    }
    return SampleRate{
        std::chrono::microseconds{load_le16(packet.subspan<0, 2>())},
        std::chrono::microseconds{load_le16(packet.subspan<2, 2>())}};
}

std::array<std::uint8_t, sample_rate_size> encode_sample_rate(const SampleRate& rate) {
    std::array<std::uint8_t, sample_rate_size> packet{};
    store_le16(std::span(packet).subspan<0, 2>(), to_word(rate.standard));
    store_le16(std::span(packet).subspan<2, 2>(), to_word(rate.express));
    return packet;
}

Result<AccessoryBoard> decode_acc_board_flag(std::span<const std::uint8_t> packet) {
    if (packet.size() != acc_board_flag_size) {
        return make_error_code(errc::length_out_of_range);
    }
    return AccessoryBoard{.controls_motor = (packet[0] & 1U) != 0};
}

std::array<std::uint8_t, acc_board_flag_size> encode_acc_board_flag(const AccessoryBoard& board) {
    return {static_cast<std::uint8_t>(board.controls_motor ? 1 : 0), 0, 0, 0};
}

std::string serial_text(const std::array<std::uint8_t, 16>& serial) {
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string text;
    text.reserve(2 * serial.size());
    for (const auto byte : serial) {
        text += digits[byte >> 4];
        text += digits[byte & 0x0F];
    }
    return text;
}

std::string short_serial_text(const std::array<std::uint8_t, 16>& serial) {
    return serial_text(serial).substr(0, 8);
}

}  // namespace sweepcast::protocol
