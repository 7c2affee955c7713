// Persona: which scanner the virtual lidar plays. A value; the code that plays it is the same for
// all.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/model.hpp"
#include "driver/protocol/reply.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace sweepcast::virtual_lidar {

/// A scan mode as GET_LIDAR_CONF reports it; its id is its place in Persona::modes.
struct ScanMode {
    std::string_view name;
    protocol::AnswerType answer{};
    std::uint32_t sample_duration_q8_us{};  ///< 1/256 microseconds
    std::uint32_t max_distance_q8_m{};      ///< 1/256 metres

    [[nodiscard]] constexpr std::chrono::nanoseconds sample_duration() const {
        return std::chrono::nanoseconds(std::uint64_t{sample_duration_q8_us} * 1000U / 256U);
    }
};

/// Speeds as GET_LIDAR_CONF reports them.
struct RotationConf {
    std::uint16_t desired_rpm{};
    std::uint16_t pwm_reference{};
    std::uint16_t min_rpm{};
    std::uint16_t max_rpm{};
};

/// How the motor turns.
struct MotorTraits {
    protocol::MotorControl control{};
    double rotation_hz{};                    ///< turns a second where nothing else is asked for
    std::chrono::milliseconds spin_up{};     ///< from rest to `rotation_hz`
    std::chrono::milliseconds coast_down{};  ///< from `rotation_hz` to rest
    double ripple{};                         ///< largest deviation from the speed, as a part of it
};

/// How well it measures.
struct BeamTraits {
    double min_distance_mm{};
    double max_distance_mm{};
    double noise_floor_mm{};  ///< standard deviation of near distances
    double noise_part{};      ///< ... and of far ones, as a part of the distance; the larger counts
};

/// What it is plugged into.
enum class Connection : std::uint8_t {
    serial,
    ethernet,  ///< UDP, unless it is played on a pseudo terminal
};

struct Persona {
    std::string_view key;    ///< how a user asks for it
    std::string_view title;  ///< how it is called in the log
    std::uint8_t model{};
    std::uint8_t firmware_major{};
    std::uint8_t firmware_minor{};
    std::uint8_t hardware{};
    std::string_view alias{};  ///< of the model's name (GET_LIDAR_CONF 0x81); mostly empty
    Connection connection{Connection::serial};
    std::uint32_t baud{};
    MotorTraits motor;
    BeamTraits beam;
    RotationConf rotation;
    std::span<const ScanMode> modes;
    std::uint16_t typical_mode{};
    std::string_view boot_text{};           ///< what it prints after RESET; may be empty
    std::chrono::milliseconds boot_time{};  ///< from RESET to the first byte of it, deaf meanwhile
    std::chrono::microseconds answer_time{};  ///< from the end of a request to its answer
};

/// The persona that a user calls `key`, e.g. "a1m8"; null if there is none.
const Persona* find_persona(std::string_view key);

/// All personas.
std::span<const Persona> personas();

/// The scan mode of this answer type; null if it has none. Of several the first.
const ScanMode* find_mode(const Persona& persona, protocol::AnswerType answer);

using SerialNumber = std::array<std::uint8_t, 16>;

/// What the exemplar with this serial number says to GET_INFO.
protocol::DeviceInfo device_info(const Persona& persona, const SerialNumber& serial);

/// The serial number of one exemplar, as a function of any text: the same text, the same number.
SerialNumber serial_from(std::string_view seed);

/// The serial number that 32 hex digits spell in wire order; none if `hex` is anything else.
std::optional<SerialNumber> parse_serial(std::string_view hex);

}  // namespace sweepcast::virtual_lidar
