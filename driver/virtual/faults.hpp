// Faults: what can be wrong with a virtual lidar or its line, so that hosts can be seen to cope.
#pragma once

#include "driver/protocol/reply.hpp"
#include "driver/protocol/result.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sweepcast::virtual_lidar {

/// Which faults a scanner has. By default none.
struct Faults {
    bool mute{};              ///< it never says anything
    bool banner{};            ///< prints its boot text again and again, and answers nothing
    bool motor_stall{};       ///< it takes scan requests, but the motor never turns
    bool sample_time_zero{};  ///< it says that a sample takes 0 us (protocol.md 13.14)
    bool bare_echo{};         ///< it echoes GET_LIDAR_CONF without a value (protocol.md 13.15)
    bool junk{};              ///< noise before every descriptor (protocol.md 13.1, 13.2)
    bool leftovers{};         ///< it is scanning already, as after a crash of its host
    bool deaf{};              ///< it hears no request; a scan that runs goes on
    bool half_answers{};      ///< of every answer it sends the first half only
    bool forced{};            ///< it measures also while its motor is not up to speed
    bool garbage{};           ///< every measurement byte is changed on the way
    bool flood{};             ///< it sends as fast as the port takes it
    double noise{};           ///< part of the bytes to the host that are changed on the way, 0..1
    double drop{};            ///< part of the bytes to the host that are lost on the way, 0..1
    double duplicate{};       ///< part of the bytes to the host that arrive twice, 0..1
    /// Bytes reach the host only so often, as behind a USB adapter (protocol.md 13.20); 0: at once.
    std::chrono::milliseconds burst{};
    std::chrono::milliseconds delay{};                  ///< by which bytes reach the host late
    std::chrono::milliseconds slow_spin_up{};           ///< from rest to speed; 0: as the model's
    std::chrono::milliseconds protection_stop_after{};  ///< of scanning; 0: never
    std::uint32_t wrong_baud{};                         ///< the line speed it has; 0: the model's
    std::optional<std::uint32_t> lying_length{};        ///< that its descriptors tell
    protocol::Health health{};                          ///< from the start and after each RESET

    bool operator==(const Faults&) const = default;
};

/// What a user can choose, for help texts: a line each, "name  what it does".
[[nodiscard]] std::string faults_help();

/// Adds the fault that `text` names to `faults`: NAME, or NAME=VALUE, as faults_help() lists them.
/// Of one that is there already the value changes. Errors: errc::invalid_option.
[[nodiscard]] Result<void, Problem> add_fault(Faults& faults, std::string_view text);

/// Takes the fault of this name away, whether it was there or not. Errors: errc::invalid_option.
[[nodiscard]] Result<void, Problem> clear_fault(Faults& faults, std::string_view name);

/// The faults as add_fault() takes them, in one order, "noise=0.02,mute"; empty if there are none.
[[nodiscard]] std::string faults_text(const Faults& faults);

/// The health code of faults for which none was given.
inline constexpr std::uint16_t usual_health_code = 1;

/// Reads a health code, "32769" or "0x8001"; none if it is not one.
[[nodiscard]] std::optional<std::uint16_t> parse_health_code(std::string_view text);

/// What a scanner with `junk` sends before a descriptor. It ends in A5, so that the descriptor
/// makes it A5 A5 5A.
[[nodiscard]] std::span<const std::uint8_t> junk_before_descriptor();

}  // namespace sweepcast::virtual_lidar
