#include "tests/driver/device/fake_scanner.hpp"

#include "driver/protocol/descriptor_hunter.hpp"
#include "driver/protocol/encode_normal.hpp"

#include <algorithm>

namespace sweepcast::device {

FakeScanner::FakeScanner(Line& line) : line_(line) {
    line_.on_write = [this](std::span<const std::uint8_t> bytes) {
        for (const auto byte : bytes) {
            if (auto request = parser_.push(byte, {})) {
                requests.push_back(*request);
                obey(*request);
            }
        }
    };
}

void FakeScanner::send_turn() {
    for (unsigned degree = 0; degree < 360; ++degree) {
        protocol::NormalMeasurement measurement;
        measurement.starts_revolution = degree == 0;
        measurement.angle = protocol::AngleQ6{static_cast<std::uint16_t>(degree * 64)};
        measurement.distance_q2 = static_cast<std::uint16_t>(4000 + degree);
        line_.send(protocol::encode_normal(measurement));
    }
}

std::size_t FakeScanner::count(protocol::Command command) const {
    return static_cast<std::size_t>(
        std::ranges::count(requests, command, &protocol::Request::command)
    );
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
    case protocol::Command::get_sample_rate: {
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
