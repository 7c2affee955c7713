#include "server/stream/lidar_message.hpp"

#include "driver/protocol/model.hpp"
#include "driver/protocol/reply.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <string_view>

namespace sweepcast::stream {

namespace {

v1::Lidar::State to_state(device::Phase phase) {
    switch (phase) {
    case device::Phase::absent:
        return v1::Lidar::ABSENT;
    case device::Phase::opening:
        return v1::Lidar::OPENING;
    case device::Phase::stalled:
        return v1::Lidar::STALLED;
    case device::Phase::resetting:
        return v1::Lidar::RESETTING;
    case device::Phase::backing_off:
        return v1::Lidar::BACKING_OFF;
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
    message.set_warning(line.warning);
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

void set_change(const device::PhaseChange& change, v1::StateChange& message) {
    message.set_from(to_state(change.from));
    message.set_to(to_state(change.to));
    set_time(change.at, *message.mutable_at());
    message.set_cause(change.cause);
}

std::chrono::system_clock::time_point to_time(const google::protobuf::Timestamp& message) {
    constexpr std::int64_t last_second = 9'000'000'000;  // of what nanoseconds can count
    return std::chrono::system_clock::time_point(
        std::chrono::seconds(std::clamp<std::int64_t>(message.seconds(), 0, last_second)) +
        std::chrono::nanoseconds(message.nanos())
    );
}

device::Phase to_phase(v1::Lidar::State state) {
    for (const auto phase : device::all_phases) {
        if (to_state(phase) == state) {
            return phase;
        }
    }
    return device::Phase::disconnected;
}

device::PhaseChange to_change(const v1::StateChange& message) {
    return {
        to_phase(message.from()),
        to_phase(message.to()),
        to_time(message.at()),
        message.cause()};
}

std::uint8_t to_byte(std::uint64_t value) {
    return static_cast<std::uint8_t>(std::min<std::uint64_t>(value, 255));
}

/// The number that `text` is in this base; 0 if it is none.
std::uint8_t parse_byte(std::string_view text, int base) {
    unsigned value{};
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    return failed == std::errc() && end == text.data() + text.size() ? to_byte(value)
                                                                     : std::uint8_t{0};
}

protocol::DeviceInfo to_info(const v1::DeviceInfo& message) {
    protocol::DeviceInfo info;
    const std::string_view firmware = message.firmware();
    const auto dot = std::min(firmware.find('.'), firmware.size());
    info.firmware_major = parse_byte(firmware.substr(0, dot), 10);
    info.firmware_minor = parse_byte(firmware.substr(std::min(dot + 1, firmware.size())), 10);
    info.hardware = to_byte(message.hardware());
    const std::string_view serial = message.serial_number();
    for (std::size_t i = 0; i < info.serial.size() && serial.size() == 2 * info.serial.size();
         ++i) {
        info.serial[i] = parse_byte(serial.substr(2 * i, 2), 16);
    }
    return info;
}

device::Rotation to_rotation(const v1::Rotation& message) {
    device::Rotation rotation;
    for (const auto control : {device::SpeedControl::duty, device::SpeedControl::rpm}) {
        if (to_control(control) == message.control()) {
            rotation.control = control;
        }
    }
    rotation.wanted_hz = message.wanted_hz();
    rotation.measured_hz = message.measured_hz();
    rotation.settled = message.settled();
    rotation.usual_hz = message.usual_hz();
    rotation.min_hz = message.min_hz();
    rotation.max_hz = message.max_hz();
    rotation.warning = message.warning();
    return rotation;
}

device::LineQuality to_line(const v1::Line& message) {
    return {
        message.baud(),
        message.bytes(),
        message.samples(),
        message.checksum_errors(),
        message.skipped_bytes(),
        message.lost_packets(),
        message.warning()};
}

device::ScanMode to_mode(const v1::ScanMode& message) {
    constexpr double mm_per_m = 1000.0;
    constexpr double ns_per_s = 1e9;
    device::ScanMode mode;
    mode.name = message.name();
    mode.answer_type = static_cast<protocol::AnswerType>(to_byte(message.answer_type()));
    if (message.samples_per_second() > 1) {
        mode.sample_duration =
            std::chrono::nanoseconds(std::llround(ns_per_s / message.samples_per_second()));
    }
    if (message.has_id()) {
        mode.id = static_cast<std::uint16_t>(message.id());
    }
    mode.max_distance_mm = message.max_distance_m() * mm_per_m;
    mode.typical = message.typical();
    return mode;
}

protocol::Health to_health(const v1::Health& message) {
    protocol::Health health;
    for (const auto status : {protocol::HealthStatus::warning, protocol::HealthStatus::error}) {
        if (to_status(status) == message.status()) {
            health.status = status;
        }
    }
    health.code = static_cast<std::uint16_t>(message.error_code());
    return health;
}

}  // namespace

device::DeviceState from_message(const v1::Lidar& message) {
    device::DeviceState state;
    state.phase = to_phase(message.state());
    state.since = to_time(message.since());
    state.cause = message.cause();
    state.hint = message.hint();
    if (message.has_next_attempt()) {
        state.next_attempt = to_time(message.next_attempt());
    }
    if (message.has_failing_since()) {
        state.failing_since = to_time(message.failing_since());
    }
    state.recoveries = message.recoveries();
    state.changes = message.state_changes();
    for (const auto& change : message.recent()) {
        if (state.recent.size() < device::recent_changes) {
            state.recent.push_back(to_change(change));
        }
    }
    state.mode = message.mode();
    if (message.has_device()) {
        state.info = to_info(message.device());
        state.alias = message.device().model();
        state.rotation = to_rotation(message.rotation());
        state.line = to_line(message.line());
    }
    if (message.has_health()) {
        state.health = to_health(message.health());
    }
    for (const auto& mode : message.modes()) {
        state.modes.push_back(to_mode(mode));
    }
    return state;
}

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
    if (state.next_attempt) {
        set_time(*state.next_attempt, *message.mutable_next_attempt());
    }
    if (state.failing_since) {
        set_time(*state.failing_since, *message.mutable_failing_since());
    }
    message.set_recoveries(state.recoveries);
    message.set_state_changes(state.changes);
    for (const auto& change : state.recent) {
        set_change(change, *message.add_recent());
    }
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
