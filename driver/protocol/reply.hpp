// Replies of one packet: device info, health, sample rate, accessory board. Decoders for the
// driver, encoders for the virtual lidar.
#pragma once

#include "driver/protocol/result.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace sweepcast::protocol {

/// Who a scanner says it is.
struct DeviceInfo {
    std::uint8_t model{};  ///< see model.hpp
    std::uint8_t firmware_major{};
    std::uint8_t firmware_minor{};
    std::uint8_t hardware{};
    std::array<std::uint8_t, 16> serial{};  ///< in wire order; see serial_text()
    bool operator==(const DeviceInfo&) const = default;
};

enum class HealthStatus : std::uint8_t {
    good = 0,
    warning = 1,  ///< still works
    error = 2,    ///< protection stop: only RESET leaves it
};

/// How a scanner feels.
struct Health {
    HealthStatus status{};
    std::uint16_t code{};  ///< the vendor's error code, 0 if good
    bool operator==(const Health&) const = default;
};

/// The time from one sample to the next in the two modes every scanner has.
struct SampleRate {
    std::chrono::microseconds standard{};
    std::chrono::microseconds express{};
    bool operator==(const SampleRate&) const = default;
};

/// What a scanner says of the board that its motor may hang on.
struct AccessoryBoard {
    bool controls_motor{};
    bool operator==(const AccessoryBoard&) const = default;
};

inline constexpr std::size_t device_info_size = 20;
inline constexpr std::size_t health_size = 3;
inline constexpr std::size_t sample_rate_size = 4;
inline constexpr std::size_t acc_board_flag_size = 4;

/// Reads the packet that answers GET_INFO. Errors: length_out_of_range. Source: protocol.md 2.
[[nodiscard]] Result<DeviceInfo> decode_device_info(std::span<const std::uint8_t> packet);
/// Reads the packet that answers GET_HEALTH. Errors: length_out_of_range, malformed_reply (a status
/// above 2). Source: protocol.md 2.
[[nodiscard]] Result<Health> decode_health(std::span<const std::uint8_t> packet);
/// Reads the packet that answers GET_SAMPLERATE. Zero is passed on: scanners have been seen to say
/// it. Errors: length_out_of_range. Source: protocol.md 2, 13.14.
[[nodiscard]] Result<SampleRate> decode_sample_rate(std::span<const std::uint8_t> packet);

/// Reads the packet that answers GET_ACC_BOARD_FLAG: whether a board can control the motor.
/// Errors: length_out_of_range. Source: protocol.md 2.
[[nodiscard]] Result<AccessoryBoard> decode_acc_board_flag(std::span<const std::uint8_t> packet);

/// The inverse of decode_device_info().
[[nodiscard]] std::array<std::uint8_t, device_info_size> encode_device_info(const DeviceInfo& info);
/// The inverse of decode_health().
[[nodiscard]] std::array<std::uint8_t, health_size> encode_health(const Health& health);
/// The inverse of decode_sample_rate(). Durations are clamped to what fits, 0..65535 us.
[[nodiscard]] std::array<std::uint8_t, sample_rate_size> encode_sample_rate(const SampleRate& rate);

/// The inverse of decode_acc_board_flag().
[[nodiscard]] std::array<std::uint8_t, acc_board_flag_size> encode_acc_board_flag(
    const AccessoryBoard& board
);

/// The serial number as printed on the scanner: 32 upper-case hex digits in wire order. Source:
/// protocol.md 2.
[[nodiscard]] std::string serial_text(const std::array<std::uint8_t, 16>& serial);
/// The first eight digits of serial_text(): enough to tell one's own scanners apart.
[[nodiscard]] std::string short_serial_text(const std::array<std::uint8_t, 16>& serial);

}  // namespace sweepcast::protocol
