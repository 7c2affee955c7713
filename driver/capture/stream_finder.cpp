#include "driver/capture/stream_finder.hpp"

#include "driver/protocol/request.hpp"

namespace sweepcast::capture {

namespace {

/// Whether a request leaves a running stream alone.
bool is_for_the_motor(std::span<const std::uint8_t> request) {
    if (request.size() < 2) {
        return false;
    }
    const auto command = static_cast<protocol::Command>(request[1]);
    return command == protocol::Command::set_motor_pwm || command == protocol::Command::motor_rpm;
}

}  // namespace

std::optional<StreamBlock> StreamFinder::push(const CaptureRecord& record) {
    if (record.direction == Direction::to_device) {
        if (!is_for_the_motor(record.bytes)) {
            end_stream();
        }
        return std::nullopt;
    }
    if (stream_) {
        return StreamBlock{*stream_, false, record.at, record.bytes};
    }
    const auto step = hunter_.push(record.bytes);
    if (!step.found) {
        return std::nullopt;
    }
    stream_ = static_cast<protocol::AnswerType>(step.found->type);
    return StreamBlock{*stream_, true, record.at, std::span(record.bytes).subspan(step.consumed)};
}

void StreamFinder::end_stream() {
    stream_.reset();
    hunter_ = protocol::DescriptorHunter(protocol::Expectation::measurement());
}

}  // namespace sweepcast::capture
