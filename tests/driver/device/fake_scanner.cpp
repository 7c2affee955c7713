#include "tests/driver/device/fake_scanner.hpp"

#include "driver/protocol/descriptor_hunter.hpp"
#include "driver/protocol/encode_normal.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>

namespace sweepcast::device {

namespace {

std::vector<std::uint8_t> le(std::uint32_t value, std::size_t size) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < size; ++i) {
        bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    return bytes;
}

}  // namespace

FakeScanner::FakeScanner(Line& line) : line_(line) {
    line_.on_write = [this](std::span<const std::uint8_t> bytes) { understand(bytes); };
}

void FakeScanner::understand(std::span<const std::uint8_t> bytes) {
    if (line_.baud != 0 && line_.baud != baud) {
        measure_speed(bytes);
        return;
    }
    for (const auto byte : bytes) {
        if (auto request = parser_.push(byte, {})) {
            requests.push_back(*request);
            obey(*request);
        }
    }
}

/// At a speed that is not its own it understands nothing but the byte to measure it by.
void FakeScanner::measure_speed(std::span<const std::uint8_t> bytes) {
    const auto is_measuring = [](std::uint8_t byte) { return byte == protocol::autobaud_byte; };
    if (negotiates && std::ranges::all_of(bytes, is_measuring)) {
        baud = line_.baud;
        line_.send(le(baud, 4));
    }
}

void FakeScanner::list_mode(
    std::uint16_t id,
    std::string_view name,
    protocol::AnswerType type,
    std::uint32_t duration_q8,
    std::uint32_t distance_q8
) {
    using protocol::ConfType;
    conf[{ConfType::mode_name, id}] = {name.begin(), name.end()};
    conf[{ConfType::mode_name, id}].push_back(0);
    conf[{ConfType::mode_answer_type, id}] = {static_cast<std::uint8_t>(type)};
    conf[{ConfType::mode_sample_duration, id}] = le(duration_q8, 4);
    conf[{ConfType::mode_max_distance, id}] = le(distance_q8, 4);
}

void FakeScanner::list_modes() {
    using protocol::AnswerType;
    using protocol::ConfType;
    conf[{ConfType::scan_mode_count, 0}] = le(3, 2);
    conf[{ConfType::typical_mode, 0}] = le(2, 2);
    list_mode(0, "Standard", AnswerType::normal, 500 * 256, 12 * 256);
    list_mode(1, "DenseBoost", AnswerType::dense, 8000, 40 * 256);
    list_mode(2, "Boost", AnswerType::ultra, 63 * 256, 25 * 256);
    conf[{ConfType::desired_rotation, 0}] = {0x58, 0x02, 0x94, 0x02};
    conf[{ConfType::min_rotation, 0}] = le(300, 2);
    conf[{ConfType::max_rotation, 0}] = le(900, 2);
}

void FakeScanner::answer_conf(const protocol::Request& request) {
    const std::span<const std::uint8_t> payload(request.payload);
    if (!knows_conf || payload.size() < 4) {
        return;
    }
    const auto type = static_cast<protocol::ConfType>(protocol::load_le32(payload.first<4>()));
    const auto mode = payload.size() >= 6 ? protocol::load_le16(payload.subspan<4, 2>()) : 0;
    std::vector<std::uint8_t> answer(payload.begin(), payload.begin() + 4);
    const auto known = conf.find({type, static_cast<std::uint16_t>(mode)});
    if (known != conf.end()) {
        answer.insert(answer.end(), known->second.begin(), known->second.end());
    }
    reply(protocol::ReplyType::lidar_conf, answer);
}

void FakeScanner::set_conf(std::span<const std::uint8_t> payload) {
    if (!set_conf_result || payload.size() < 4) {
        return;
    }
    const auto type = static_cast<protocol::ConfType>(protocol::load_le32(payload.first<4>()));
    if (*set_conf_result == 0 && keeps_conf) {
        conf[{type, 0}] = {payload.begin() + 4, payload.end()};
    }
    std::vector<std::uint8_t> answer(payload.begin(), payload.begin() + 4);
    const auto result = le(*set_conf_result, 4);
    answer.insert(answer.end(), result.begin(), result.end());
    reply(protocol::ReplyType::set_lidar_conf, answer);
}

void FakeScanner::send_turn() {
    for (unsigned degree = 0; degree < 360; ++degree) {
        send_sample(degree);
    }
}

void FakeScanner::send_sample(unsigned degree) {
    protocol::NormalMeasurement measurement;
    measurement.starts_revolution = degree == 0;
    measurement.angle = protocol::AngleQ6{static_cast<std::uint16_t>(degree * 64)};
    measurement.distance_q2 = static_cast<std::uint16_t>(4000 + degree);
    line_.send(protocol::encode_normal(measurement));
}

std::size_t FakeScanner::count(protocol::Command command) const {
    return static_cast<std::size_t>(
        std::ranges::count(requests, command, &protocol::Request::command)
    );
}

std::span<const protocol::Request> FakeScanner::since_scan() const {
    const auto is_scan = [](const protocol::Request& request) {
        return request.command == protocol::Command::scan ||
               request.command == protocol::Command::express_scan;
    };
    const auto latest = std::find_if(requests.rbegin(), requests.rend(), is_scan).base();
    return {latest, requests.end()};
}

void FakeScanner::obey(const protocol::Request& request) {
    if (!answers) {
        return;
    }
    switch (request.command) {
    case protocol::Command::get_info:
        return reply(protocol::ReplyType::device_info, protocol::encode_device_info(info));
    case protocol::Command::get_health:
        return reply(protocol::ReplyType::health, protocol::encode_health(health));
    case protocol::Command::get_lidar_conf:
        return answer_conf(request);
    case protocol::Command::set_lidar_conf:
        return set_conf(request.payload);
    case protocol::Command::get_acc_board_flag:
        if (board) {
            reply(protocol::ReplyType::acc_board_flag, protocol::encode_acc_board_flag(*board));
        }
        return;
    case protocol::Command::get_sample_rate: {
        if (!knows_sample_rate) {
            return;
        }
        using std::chrono::microseconds;
        const protocol::SampleRate rate{microseconds(500), microseconds(250)};
        return reply(protocol::ReplyType::sample_rate, protocol::encode_sample_rate(rate));
    }
    case protocol::Command::reset:
        if (reset_heals) {
            health = {};
        }
        return;
    case protocol::Command::scan:
    case protocol::Command::express_scan:
        // Streams 0x81 whatever was asked: the descriptor decides.
        line_.send(protocol::encode_descriptor({5, true, 0x81}));
        for (int turn = 0; turn < turns_at_start; ++turn) {
            send_turn();
        }
        return;
    default:
        return;
    }
}

void FakeScanner::reply(protocol::ReplyType type, std::span<const std::uint8_t> payload) {
    const protocol::Descriptor descriptor{
        static_cast<std::uint32_t>(payload.size()),
        false,
        static_cast<std::uint8_t>(type)};
    line_.send(protocol::encode_descriptor(descriptor));
    line_.send(payload);
}

}  // namespace sweepcast::device
