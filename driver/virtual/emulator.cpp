#include "driver/virtual/emulator.hpp"

#include "driver/protocol/descriptor_hunter.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace {

using namespace std::chrono_literals;
using protocol::Command;

// What the scanner's UART and the USB adapter hold when a scan is stopped: it still arrives, and
// ends inside a packet (protocol.md 11.3).
constexpr std::size_t bytes_beyond_recall = 64;

// Beyond this a scan is not caught up with. Less than the transmit queue holds, so that a process
// that was merely not scheduled loses nothing.
constexpr auto longest_catch_up = 300ms;

bool is_motor_command(Command command) {
    return command == Command::set_motor_pwm || command == Command::motor_rpm;
}

protocol::SampleTime in_microseconds(Moment moment) {
    return std::chrono::floor<std::chrono::microseconds>(moment);
}

std::vector<std::uint8_t> stream_descriptor(const ScanMode& mode) {
    const auto descriptor = protocol::encode_descriptor({
        .length = static_cast<std::uint32_t>(protocol::packet_size(mode.answer)),
        .many = true,
        .type = static_cast<std::uint8_t>(mode.answer),
    });
    return {descriptor.begin(), descriptor.end()};
}

}  // namespace

Emulator::Emulator(
    const Persona& persona,
    const SerialNumber& serial,
    Beam beam,
    Moment now,
    OnEvent on_event
)
    : persona_(&persona)
    , serial_(serial)
    , beam_(std::move(beam))
    , switched_on_(now)
    , alive_until_(now)
    , on_event_(std::move(on_event))
    , motor_(persona.motor, now)
    , line_(persona.baud) {
    motor_.switch_to(true, now);
}

void Emulator::receive(std::span<const std::uint8_t> bytes, Moment now) {
    advance(now);
    for (const auto byte : bytes) {
        if (const auto request = parser_.push(byte, in_microseconds(now))) {
            serve(*request, now);
        }
    }
}

void Emulator::serve(const protocol::Request& request, Moment now) {
    if (request.command == Command::set_motor_pwm) {
        switch_motor(request.payload, now);
        return;
    }
    if (is_motor_command(request.command) || booted_at_) {
        return;
    }
    if (scan_) {  // any other request ends a scan, and is then served
        stop_scan(now);
    } else if (line_.is_answering(now)) {
        return;  // one request at a time: others are discarded meanwhile (protocol.md 1.2)
    }
    serve_idle(request, now);
}

void Emulator::serve_idle(const protocol::Request& request, Moment now) {
    switch (request.command) {
    case Command::scan:
    case Command::force_scan:
        start_scan(persona_->modes.front(), request.command == Command::force_scan, now);
        return;
    case Command::express_scan:
        start_express(request.payload, now);
        return;
    case Command::reset:
        reset(now);
        return;
    default:
        if (const auto answer = answer_to(request, *persona_, serial_, health_)) {
            send(Payload::answer, *answer, now);
        }
    }
}

void Emulator::switch_motor(std::span<const std::uint8_t> payload, Moment now) {
    if (payload.size() < 2) {
        return;
    }
    const bool on = protocol::load_le16(payload.first<2>()) != 0;
    if (motor_.switch_to(on, now)) {
        on_event_({on ? Occurrence::motor_on : Occurrence::motor_off});
    }
}

// Mode 0 is legacy express; any other is the id of a mode, and modes that SCAN starts are not
// started this way (protocol.md 2, 12).
void Emulator::start_express(std::span<const std::uint8_t> payload, Moment now) {
    constexpr std::size_t payload_size = 5;
    if (payload.size() < payload_size) {
        return;
    }
    const auto is_express = [](const ScanMode& mode) {
        return mode.answer == protocol::AnswerType::express;
    };
    const auto& modes = persona_->modes;
    const std::size_t id = payload[0];
    auto chosen = modes.end();
    if (id == 0) {
        chosen = std::find_if(modes.begin(), modes.end(), is_express);
    } else if (id < modes.size()) {
        chosen = modes.begin() + static_cast<std::ptrdiff_t>(id);
    }
    if (chosen != modes.end() && chosen->answer != protocol::AnswerType::normal) {
        start_scan(*chosen, false, now);
    }
}

void Emulator::start_scan(const ScanMode& mode, bool forced, Moment now) {
    if (health_.status == protocol::HealthStatus::error) {
        return;
    }
    send(Payload::answer, stream_descriptor(mode), now);
    scan_ = Scan{.mode = &mode, .forced = forced, .requested = now};
    on_event_({Occurrence::scan_started, &mode});
}

void Emulator::stop_scan(Moment now) {
    line_.drop_measurements(now, bytes_beyond_recall);
    const auto* const mode = scan_->mode;
    scan_.reset();
    on_event_({Occurrence::scan_stopped, mode});
}

void Emulator::reset(Moment now) {
    health_ = {};
    booted_at_ = now + persona_->boot_time;
    on_event_({Occurrence::reset});
}

void Emulator::finish_boot() {
    const auto& text = persona_->boot_text;
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    send(Payload::answer, bytes, *booted_at_);
    booted_at_.reset();
}

void Emulator::enter_protection_stop(std::uint16_t code, Moment now) {
    advance(now);
    if (scan_) {
        stop_scan(now);
    }
    health_ = {protocol::HealthStatus::error, code};
    on_event_({Occurrence::protection_stop});
}

void Emulator::advance(Moment now) {
    if (booted_at_ && *booted_at_ <= now) {
        finish_boot();
    }
    if (scan_ && scan_->stream && now - alive_until_ > longest_catch_up) {
        scan_->stream.reset();
        scan_->requested = now;
    }
    alive_until_ = std::max(alive_until_, now);
    while (scan_ && advance_scan(now)) {
    }
}

// One step: begins the stream, pauses it, or sends a packet. False when there is nothing to do yet.
bool Emulator::advance_scan(Moment now) {
    auto& stream = scan_->stream;
    if (!stream) {
        return begin_stream(now);
    }
    const auto ready = stream->packet_ready();
    if (ready > now) {
        return false;
    }
    if (!scan_->forced && !motor_.is_stable(stream->packet_end())) {
        stream.reset();
        return true;
    }
    send(Payload::measurement, stream->measure(motor_, beam_, switched_on_), ready);
    return true;
}

bool Emulator::begin_stream(Moment now) {
    auto begin = scan_->requested;
    if (!scan_->forced) {
        const auto stable_from = motor_.stable_from();
        if (!stable_from) {
            return false;
        }
        begin = std::max(begin, *stable_from);
    }
    if (begin > now) {
        return false;
    }
    scan_->stream.emplace(*scan_->mode, motor_, begin);
    return true;
}

std::optional<Moment> Emulator::next_due() const {
    std::optional<Moment> due = line_.next_byte();
    const auto consider = [&due](std::optional<Moment> moment) {
        if (moment && (!due || *moment < *due)) {
            due = moment;
        }
    };
    consider(booted_at_);
    if (scan_ && scan_->stream) {
        consider(scan_->stream->packet_ready());
    } else if (scan_ && !scan_->forced) {
        consider(motor_.stable_from());
    }
    return due;
}

void Emulator::send(Payload payload, std::span<const std::uint8_t> bytes, Moment ready) {
    if (!line_.push(payload, bytes, ready)) {
        overrun_bytes_ += bytes.size();
    }
}

}  // namespace sweepcast::virtual_lidar
