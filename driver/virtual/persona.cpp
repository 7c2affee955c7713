// All personas, and what names and numbers them.
#include "driver/virtual/persona.hpp"

#include "driver/virtual/persona_families.hpp"
#include "driver/virtual/random.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <vector>

namespace sweepcast::virtual_lidar {

namespace {

const std::vector<Persona>& all_personas() {
    static const auto all = [] {
        std::vector<Persona> both;
        for (const auto family : {triangulation_personas(), time_of_flight_personas()}) {
            both.insert(both.end(), family.begin(), family.end());
        }
        return both;
    }();
    return all;
}

}  // namespace

const Persona* find_persona(std::string_view key) {
    const auto& all = all_personas();
    const auto found = std::ranges::find(all, key, &Persona::key);
    return found != all.end() ? &*found : nullptr;
}

std::span<const Persona> personas() {
    return all_personas();
}

const ScanMode* find_mode(const Persona& persona, protocol::AnswerType answer) {
    const auto found = std::ranges::find(persona.modes, answer, &ScanMode::answer);
    return found != persona.modes.end() ? &*found : nullptr;
}

protocol::DeviceInfo device_info(const Persona& persona, const SerialNumber& serial) {
    return {
        .model = persona.model,
        .firmware_major = persona.firmware_major,
        .firmware_minor = persona.firmware_minor,
        .hardware = persona.hardware,
        .serial = serial,
    };
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
