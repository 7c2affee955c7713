#include "server/stream/lidar_message.hpp"

#include "driver/protocol/model.hpp"
#include "driver/protocol/reply.hpp"

#include <fmt/format.h>

#include <chrono>

namespace sweepcast::stream {

namespace {

v1::Lidar::State to_state(device::Phase phase) {
    switch (phase) {
    case device::Phase::disconnected:
        return v1::Lidar::DISCONNECTED;
    case device::Phase::identifying:
        return v1::Lidar::IDENTIFYING;
    case device::Phase::idle:
        return v1::Lidar::IDLE;
    case device::Phase::starting:
        return v1::Lidar::STARTING;
    case device::Phase::scanning:
        return v1::Lidar::SCANNING;
    case device::Phase::stopping:
        return v1::Lidar::STOPPING;
    case device::Phase::protection_stop:
        return v1::Lidar::PROTECTION_STOP;
    case device::Phase::failed:
        return v1::Lidar::FAILED;
    }
    return v1::Lidar::UNKNOWN;
}

v1::Health::Status to_status(protocol::HealthStatus status) {
    switch (status) {
    case protocol::HealthStatus::good:
        return v1::Health::GOOD;
    case protocol::HealthStatus::warning:
        return v1::Health::WARNING;
    case protocol::HealthStatus::error:
        return v1::Health::ERROR;
    }
    return v1::Health::UNKNOWN;
}

v1::Rotation::Control to_control(device::SpeedControl control) {
    switch (control) {
    case device::SpeedControl::fixed:
        return v1::Rotation::FIXED;
    case device::SpeedControl::duty:
        return v1::Rotation::DUTY;
    case device::SpeedControl::rpm:
        return v1::Rotation::RPM;
    }
    return v1::Rotation::UNKNOWN;
}

void set_rotation(const device::Rotation& rotation, v1::Rotation& message) {
    message.set_control(to_control(rotation.control));
    message.set_wanted_hz(rotation.wanted_hz);
    message.set_measured_hz(rotation.measured_hz);
    message.set_settled(rotation.settled);
    message.set_usual_hz(rotation.usual_hz);
    message.set_min_hz(rotation.min_hz);
    message.set_max_hz(rotation.max_hz);
    message.set_warning(rotation.warning);
}

void set_line(const device::LineQuality& line, v1::Line& message) {
    message.set_baud(line.baud);
    message.set_bytes(line.bytes);
    message.set_samples(line.samples);
    message.set_checksum_errors(line.checksum_errors);
    message.set_skipped_bytes(line.skipped_bytes);
    message.set_lost_packets(line.lost_packets);
}

void set_mode(const device::ScanMode& mode, v1::ScanMode& message) {
    constexpr double mm_per_m = 1000.0;
    message.set_name(mode.name);
    message.set_answer_type(static_cast<std::uint32_t>(mode.answer_type));
    message.set_samples_per_second(mode.samples_per_second());
    message.set_max_distance_m(mode.max_distance_mm / mm_per_m);
    if (mode.id) {
        message.set_id(*mode.id);
    }
    message.set_typical(mode.typical);
}

void set_device(
    const protocol::DeviceInfo& info,
    const std::string& alias,
    v1::DeviceInfo& message
) {
    message.set_model(alias.empty() ? protocol::model_name(info.model) : alias);
    message.set_serial_number(protocol::serial_text(info.serial));
    message.set_firmware(fmt::format("{}.{:02}", info.firmware_major, info.firmware_minor));
    message.set_hardware(info.hardware);
}

void set_time(std::chrono::system_clock::time_point time, google::protobuf::Timestamp& message) {
    const auto since_epoch = time.time_since_epoch();
    const auto seconds = std::chrono::floor<std::chrono::seconds>(since_epoch);
    message.set_seconds(seconds.count());
    message.set_nanos(
        static_cast<std::int32_t>(std::chrono::nanoseconds(since_epoch - seconds).count())
    );
}

}  // namespace

void to_message(const hub::LidarSnapshot& lidar, v1::Lidar& message) {
    message.set_number(lidar.number);
    message.set_id(lidar.id);
    message.set_url(lidar.url);
    message.set_is_virtual(lidar.is_virtual);
    message.set_is_stand_in(lidar.is_stand_in);
    const auto& state = lidar.state;
    message.set_state(to_state(state.phase));
    set_time(state.since, *message.mutable_since());
    message.set_cause(state.cause);
    message.set_hint(state.hint);
    message.set_mode(state.mode);
    if (state.info) {
        set_device(*state.info, state.alias, *message.mutable_device());
        set_rotation(state.rotation, *message.mutable_rotation());
        set_line(state.line, *message.mutable_line());
    }
    if (state.health) {
        message.mutable_health()->set_status(to_status(state.health->status));
        message.mutable_health()->set_error_code(state.health->code);
    }
    for (const auto& mode : state.modes) {
        set_mode(mode, *message.add_modes());
    }
}

}  // namespace sweepcast::stream
