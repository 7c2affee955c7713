#include "driver/virtual/answers.hpp"

#include "driver/protocol/descriptor_hunter.hpp"
#include "driver/protocol/model.hpp"
#include "driver/protocol/wire.hpp"
#include "driver/virtual/conf_values.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>

namespace sweepcast::virtual_lidar {

namespace {

using Bytes = std::vector<std::uint8_t>;
using protocol::Command;
using protocol::ConfType;
using protocol::ReplyType;

// Results of SET_LIDAR_CONF (protocol.md 9).
constexpr std::uint32_t result_ok = 0;
constexpr std::uint32_t result_not_supported = 0x8000'8004;
constexpr std::uint32_t result_bad_format = 0x8000'8005;

Bytes joined(std::span<const std::uint8_t> first, std::span<const std::uint8_t> second) {
    Bytes both(first.size() + second.size());
    std::copy(second.begin(), second.end(), std::copy(first.begin(), first.end(), both.begin()));
    return both;
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
protocol::SampleRate sample_rate(const Persona& persona, const Unit& unit) {
    if (unit.says_no_sample_time) {
        return {};
    }
    const auto& standard = persona.modes.front();
    const auto* const express = find_mode(persona, protocol::AnswerType::express);
    using std::chrono::duration_cast;
    using std::chrono::microseconds;
    return {
        .standard = duration_cast<microseconds>(standard.sample_duration()),
        .express = duration_cast<microseconds>((express ? *express : standard).sample_duration()),
    };
}

std::optional<Bytes>
conf_answer(std::span<const std::uint8_t> payload, const Persona& persona, const Unit& unit) {
    if (payload.size() < 4) {
        return std::nullopt;
    }
    const auto type = ConfType{protocol::load_le32(payload.first<4>())};
    const auto value = conf_value(type, payload.subspan(4), persona, unit);
    return packet(ReplyType::lidar_conf, joined(payload.first<4>(), value));
}

std::uint32_t
set_conf(ConfType type, std::span<const std::uint8_t> value, const Persona& persona, Unit& unit) {
    if (type != ConfType::static_ip || persona.connection != Connection::ethernet) {
        return result_not_supported;
    }
    const auto address = protocol::decode_static_ip(value);
    if (!address) {
        return result_bad_format;
    }
    unit.static_ip = *address;
    return result_ok;
}

std::optional<Bytes>
set_conf_answer(std::span<const std::uint8_t> payload, const Persona& persona, Unit& unit) {
    if (payload.size() < 4) {
        return std::nullopt;
    }
    const auto type = ConfType{protocol::load_le32(payload.first<4>())};
    std::array<std::uint8_t, 4> result{};
    protocol::store_le32(result, set_conf(type, payload.subspan(4), persona, unit));
    return packet(ReplyType::set_lidar_conf, joined(payload.first<4>(), result));
}

// Whether there is an accessory board, and it can control the motor.
std::optional<Bytes> board_answer(const Persona& persona) {
    constexpr std::array<std::uint8_t, 4> by_pwm{1, 0, 0, 0};
    if (persona.motor.control != protocol::MotorControl::accessory_board) {
        return std::nullopt;
    }
    return packet(ReplyType::acc_board_flag, by_pwm);
}

}  // namespace

std::optional<std::vector<std::uint8_t>>
answer_to(const protocol::Request& request, const Persona& persona, Unit& unit) {
    const auto info = device_info(persona, unit.serial);
    switch (request.command) {
    case Command::get_info:
        return packet(ReplyType::device_info, protocol::encode_device_info(info));
    case Command::get_health:
        return packet(ReplyType::health, protocol::encode_health(unit.health));
    case Command::get_sample_rate:
        if (!protocol::knows_express(info)) {
            return std::nullopt;
        }
        return packet(
            ReplyType::sample_rate,
            protocol::encode_sample_rate(sample_rate(persona, unit))
        );
    case Command::get_lidar_conf:
        return protocol::knows_lidar_conf(info) ? conf_answer(request.payload, persona, unit)
                                                : std::nullopt;
    case Command::set_lidar_conf:
        return protocol::knows_lidar_conf(info) ? set_conf_answer(request.payload, persona, unit)
                                                : std::nullopt;
    case Command::get_acc_board_flag:
        return board_answer(persona);
    default:
        return std::nullopt;
    }
}

}  // namespace sweepcast::virtual_lidar
