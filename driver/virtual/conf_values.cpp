#include "driver/virtual/conf_values.hpp"

#include "driver/protocol/wire.hpp"

#include <array>
#include <string_view>

namespace sweepcast::virtual_lidar {

namespace {

using Bytes = std::vector<std::uint8_t>;
using protocol::ConfType;

Bytes le16(std::uint16_t value) {
    std::array<std::uint8_t, 2> bytes{};
    protocol::store_le16(bytes, value);
    return {bytes.begin(), bytes.end()};
}

Bytes le32(std::uint32_t value) {
    std::array<std::uint8_t, 4> bytes{};
    protocol::store_le32(bytes, value);
    return {bytes.begin(), bytes.end()};
}

Bytes zero_terminated(std::string_view text) {
    Bytes out(text.begin(), text.end());
    out.push_back(0);
    return out;
}

Bytes desired_rotation(const RotationConf& rotation) {
    auto value = le16(rotation.desired_rpm);
    const auto pwm = le16(rotation.pwm_reference);
    value.insert(value.end(), pwm.begin(), pwm.end());
    return value;
}

// Locally administered, and of this exemplar. Only scanners with Ethernet have one: hosts conclude
// from it how they are connected (protocol.md 4.3).
Bytes mac_address(const Unit& unit) {
    if (!unit.on_ethernet) {
        return {};
    }
    Bytes address{0x02};
    address.insert(address.end(), unit.serial.begin(), unit.serial.begin() + 5);
    return address;
}

Bytes mode_value(ConfType type, const ScanMode& mode, const Unit& unit) {
    switch (type) {
    case ConfType::mode_sample_duration:
        return le32(unit.says_no_sample_time ? 0 : mode.sample_duration_q8_us);
    case ConfType::mode_max_distance:
        return le32(mode.max_distance_q8_m);
    case ConfType::mode_answer_type:
        return {static_cast<std::uint8_t>(mode.answer)};
    default:
        return zero_terminated(mode.name);
    }
}

}  // namespace

std::vector<std::uint8_t> conf_value(
    ConfType type,
    std::span<const std::uint8_t> arguments,
    const Persona& persona,
    const Unit& unit
) {
    if (unit.echoes_confs) {
        return {};
    }
    switch (type) {
    case ConfType::desired_rotation:
        return desired_rotation(persona.rotation);
    case ConfType::min_rotation:
        return le16(persona.rotation.min_rpm);
    case ConfType::max_rotation:
        return le16(persona.rotation.max_rpm);
    case ConfType::scan_mode_count:
        return le16(static_cast<std::uint16_t>(persona.modes.size()));
    case ConfType::typical_mode:
        return le16(persona.typical_mode);
    case ConfType::model_alias:
        return zero_terminated(persona.alias);
    case ConfType::mac_address:
        return mac_address(unit);
    case ConfType::static_ip:
        return persona.connection == Connection::ethernet
                   ? protocol::encode_static_ip(unit.static_ip)
                   : Bytes{};
    case ConfType::mode_sample_duration:
    case ConfType::mode_max_distance:
    case ConfType::mode_answer_type:
    case ConfType::mode_name: {
        if (arguments.size() < 2) {
            return {};
        }
        const auto id = protocol::load_le16(arguments.first<2>());
        return id < persona.modes.size() ? mode_value(type, persona.modes[id], unit) : Bytes{};
    }
    }
    return {};
}

}  // namespace sweepcast::virtual_lidar
