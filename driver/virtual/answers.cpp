#include "driver/virtual/answers.hpp"

#include "driver/protocol/descriptor_hunter.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace sweepcast::virtual_lidar {

namespace {

using Bytes = std::vector<std::uint8_t>;
using protocol::Command;
using protocol::ReplyType;

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

Bytes joined(std::span<const std::uint8_t> first, std::span<const std::uint8_t> second) {
    Bytes both(first.size() + second.size());
    std::copy(second.begin(), second.end(), std::copy(first.begin(), first.end(), both.begin()));
    return both;
}

Bytes zero_terminated(std::string_view text) {
    Bytes out(text.begin(), text.end());
    out.push_back(0);
    return out;
}

Bytes packet(ReplyType type, std::span<const std::uint8_t> payload) {
    const auto descriptor = protocol::encode_descriptor({
        .length = static_cast<std::uint32_t>(payload.size()),
        .many = false,
        .type = static_cast<std::uint8_t>(type),
    });
    return joined(descriptor, payload);
}

// SCAN is the first mode; "express" here is the first one that is streamed in 0x82 capsules.
protocol::SampleRate sample_rate(const Persona& persona) {
    const auto express =
        std::find_if(persona.modes.begin(), persona.modes.end(), [](const ScanMode& mode) {
            return mode.answer == protocol::AnswerType::express;
        });
    const auto& fast = express != persona.modes.end() ? *express : persona.modes.front();
    using std::chrono::duration_cast;
    using std::chrono::microseconds;
    return {
        .standard = duration_cast<microseconds>(persona.modes.front().sample_duration()),
        .express = duration_cast<microseconds>(fast.sample_duration()),
    };
}

std::optional<Bytes> conf_answer(const Persona& persona, std::span<const std::uint8_t> payload) {
    if (payload.size() < 4) {
        return std::nullopt;
    }
    const auto type = protocol::load_le32(payload.first<4>());
    const auto value = conf_value(persona, type, payload.subspan(4));
    return packet(ReplyType::lidar_conf, joined(le32(type), value));
}

// Nothing can be set on the scanners played so far.
std::optional<Bytes> set_conf_answer(std::span<const std::uint8_t> payload) {
    constexpr std::uint32_t not_supported = 0x8000'8004;  // protocol.md 9, result codes
    if (payload.size() < 4) {
        return std::nullopt;
    }
    return packet(ReplyType::set_lidar_conf, joined(payload.first<4>(), le32(not_supported)));
}

Bytes mode_value(const ScanMode& mode, std::uint32_t type) {
    switch (type) {
    case 0x71:
        return le32(mode.sample_duration_q8_us);
    case 0x74:
        return le32(mode.max_distance_q8_m);
    case 0x75:
        return {static_cast<std::uint8_t>(mode.answer)};
    default:
        return zero_terminated(mode.name);
    }
}

}  // namespace

std::vector<std::uint8_t>
conf_value(const Persona& persona, std::uint32_t type, std::span<const std::uint8_t> arguments) {
    switch (type) {
    case 0x01:
        return joined(le16(persona.rotation.desired_rpm), le16(persona.rotation.pwm_reference));
    case 0x04:
        return le16(persona.rotation.min_rpm);
    case 0x05:
        return le16(persona.rotation.max_rpm);
    case 0x70:
        return le16(static_cast<std::uint16_t>(persona.modes.size()));
    case 0x7C:
        return le16(persona.typical_mode);
    case 0x81:  // the alias of the model's name, which none has
        return zero_terminated("");
    case 0x71:
    case 0x74:
    case 0x75:
    case 0x7F: {
        if (arguments.size() < 2) {
            return {};
        }
        const auto id = protocol::load_le16(arguments.first<2>());
        return id < persona.modes.size() ? mode_value(persona.modes[id], type) : Bytes{};
    }
    default:
        return {};
    }
}

std::optional<std::vector<std::uint8_t>> answer_to(
    const protocol::Request& request,
    const Persona& persona,
    const SerialNumber& serial,
    const protocol::Health& health
) {
    switch (request.command) {
    case Command::get_info:
        return packet(
            ReplyType::device_info,
            protocol::encode_device_info({
                .model = persona.model,
                .firmware_major = persona.firmware_major,
                .firmware_minor = persona.firmware_minor,
                .hardware = persona.hardware,
                .serial = serial,
            })
        );
    case Command::get_health:
        return packet(ReplyType::health, protocol::encode_health(health));
    case Command::get_sample_rate:
        return packet(ReplyType::sample_rate, protocol::encode_sample_rate(sample_rate(persona)));
    case Command::get_lidar_conf:
        return conf_answer(persona, request.payload);
    case Command::set_lidar_conf:
        return set_conf_answer(request.payload);
    default:
        return std::nullopt;
    }
}

}  // namespace sweepcast::virtual_lidar
