#include "driver/virtual/persona.hpp"

#include "driver/virtual/random.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace sweepcast::virtual_lidar {

namespace {

using namespace std::chrono_literals;
using protocol::AnswerType;

// The ids, rates and ranges that an A1 of firmware 1.24 and later reports (protocol.md 6). Its
// third mode, Boost, is not played.
constexpr std::array a1m8_modes{
    ScanMode{"Standard", AnswerType::normal, 500U * 256U, 12U * 256U},
    ScanMode{"Express", AnswerType::express, 250U * 256U, 12U * 256U},
};

constexpr std::array all_personas{
    Persona{
        .key = "a1m8",
        .title = "RPLIDAR A1M8",
        .model = 0x18,
        .firmware_major = 1,
        .firmware_minor = 29,
        .hardware = 7,
        .baud = 115'200,
        // 5.5 turns a second is what the belt gives at 5 V. Nothing regulates it: the speeds under
        // `rotation` are references for an accessory board, which an A1 reports but does not have.
        .motor = {.rotation_hz = 5.5, .spin_up = 1000ms, .coast_down = 1500ms, .ripple = 0.005},
        .beam =
            {.min_distance_mm = 150.0,
             .max_distance_mm = 12'000.0,
             .noise_floor_mm = 1.5,
             .noise_part = 0.002},
        .rotation = {.desired_rpm = 600, .pwm_reference = 660, .min_rpm = 300, .max_rpm = 900},
        .modes = a1m8_modes,
        .typical_mode = 1,
        // Three lines as A models print them (protocol.md 11.2).
        .boot_text = "RP LIDAR System.\r\nFirmware Ver 1.29 - rtm, HW Ver 7\r\nModel: 18\r\n",
        .boot_time = 10ms,
    },
};

}  // namespace

const Persona* find_persona(std::string_view key) {
    const auto* const found =
        std::find_if(all_personas.begin(), all_personas.end(), [key](const Persona& persona) {
            return persona.key == key;
        });
    return found != all_personas.end() ? found : nullptr;
}

std::span<const Persona> personas() {
    return all_personas;
}

SerialNumber serial_from(std::string_view seed) {
    std::uint64_t hash = 0xCBF29CE484222325U;  // FNV-1a
    for (const char c : seed) {
        hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x100000001B3U;
    }
    Random random(hash);
    SerialNumber serial{};
    for (auto& byte : serial) {
        byte = static_cast<std::uint8_t>(random.next() >> 56U);
    }
    return serial;
}

std::optional<SerialNumber> parse_serial(std::string_view hex) {
    SerialNumber serial{};
    if (hex.size() != 2 * serial.size()) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < serial.size(); ++i) {
        const auto* const digits = hex.data() + 2 * i;
        const auto [stop, failure] = std::from_chars(digits, digits + 2, serial[i], 16);
        if (failure != std::errc{} || stop != digits + 2) {
            return std::nullopt;
        }
    }
    return serial;
}

}  // namespace sweepcast::virtual_lidar
