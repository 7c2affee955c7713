// Configuration: GET_LIDAR_CONF and SET_LIDAR_CONF, what they ask and what comes back.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/request.hpp"
#include "driver/protocol/result.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sweepcast::protocol {

/// What can be asked for (protocol.md 3). A scanner may be asked others: the value is not limited
/// to these.
enum class ConfType : std::uint32_t {
    desired_rotation = 0x01,
    min_rotation = 0x04,
    max_rotation = 0x05,
    scan_mode_count = 0x70,
    mode_sample_duration = 0x71,
    mode_max_distance = 0x74,
    mode_answer_type = 0x75,
    mac_address = 0x79,
    typical_mode = 0x7C,
    mode_name = 0x7F,
    model_alias = 0x81,
    static_ip = 0x1CCC0,
};

/// The speed a scanner wishes for.
struct DesiredRotation {
    std::uint16_t rpm{};
    std::uint16_t pwm{};  ///< the duty that gives about that speed behind an accessory board
    bool operator==(const DesiredRotation&) const = default;
};

/// The address of a scanner on a network.
struct StaticIp {
    std::array<std::uint8_t, 4> address{};
    std::array<std::uint8_t, 4> netmask{};
    std::array<std::uint8_t, 4> gateway{};
    bool operator==(const StaticIp&) const = default;
};

/// Asks for a value; `arguments` follow the type.
[[nodiscard]] Request get_conf_request(ConfType type, std::span<const std::uint8_t> arguments = {});
/// Asks for a value of one scan mode.
[[nodiscard]] Request get_mode_conf_request(ConfType type, std::uint16_t mode);
/// Sets a value.
[[nodiscard]] Request set_conf_request(ConfType type, std::span<const std::uint8_t> value);

/// The value in an answer to GET_LIDAR_CONF: what follows the echoed type. Valid as long as
/// `packet`. Errors: length_out_of_range, conf_type_mismatch (an answer to another question),
/// conf_not_supported (the bare echo by which a scanner says that it does not know the type).
[[nodiscard]] Result<std::span<const std::uint8_t>>
decode_conf(std::span<const std::uint8_t> packet, ConfType asked);

/// Whether a SET_LIDAR_CONF took effect. Errors: length_out_of_range, conf_type_mismatch,
/// conf_refused.
[[nodiscard]] Result<void> decode_set_conf(std::span<const std::uint8_t> packet, ConfType asked);

/// The readers of values. Errors: length_out_of_range for a value too short for its meaning; bytes
/// beyond it are ignored, since firmware may say more one day.
[[nodiscard]] Result<std::uint16_t> decode_conf_u16(std::span<const std::uint8_t> value);
[[nodiscard]] Result<DesiredRotation> decode_desired_rotation(std::span<const std::uint8_t> value);
[[nodiscard]] Result<StaticIp> decode_static_ip(std::span<const std::uint8_t> value);
/// From one sample to the next; zero is passed on: a scanner in the field says it (protocol.md
/// 13.14).
[[nodiscard]] Result<std::chrono::nanoseconds> decode_mode_sample_duration(
    std::span<const std::uint8_t> value
);
/// In millimetres.
[[nodiscard]] Result<double> decode_mode_max_distance(std::span<const std::uint8_t> value);
/// Any byte: whether the type can be decoded is for who decodes it.
[[nodiscard]] Result<AnswerType> decode_mode_answer_type(std::span<const std::uint8_t> value);
/// Text up to a zero or the end, at most 64 bytes, printable ASCII only. May be empty; never an
/// error.
[[nodiscard]] Result<std::string> decode_conf_text(std::span<const std::uint8_t> value);

[[nodiscard]] std::vector<std::uint8_t> encode_static_ip(const StaticIp& address);

}  // namespace sweepcast::protocol
