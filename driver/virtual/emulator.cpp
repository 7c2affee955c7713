#include "driver/virtual/emulator.hpp"

#include "driver/protocol/descriptor_hunter.hpp"
#include "driver/protocol/model.hpp"
#include "driver/protocol/wire.hpp"
#include "driver/virtual/uart.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
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

constexpr auto banner_period = 500ms;

// Ethernet of 100 Mbit/s carries ten times this many bytes a second; ten bits a byte is how a
// TransmitLine counts.
constexpr std::uint32_t ethernet_baud = 100'000'000;

std::uint32_t starting_baud(const Persona& persona, const EmulatorSettings& settings) {
    return settings.on_ethernet ? ethernet_baud : persona.baud;
}

bool is_scan_request(Command command) {
    return command == Command::scan || command == Command::force_scan ||
           command == Command::express_scan || command == Command::hq_scan;
}

protocol::SampleTime in_microseconds(Moment moment) {
    return std::chrono::floor<std::chrono::microseconds>(moment);
}

std::vector<std::uint8_t> bytes_of(std::string_view text) {
    return {text.begin(), text.end()};
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
    OnEvent on_event,
    const EmulatorSettings& settings
)
    : persona_(&persona)
    , settings_(settings)
    , unit_{
          .serial = serial,
          .health = settings.faults.health,
          .on_ethernet = settings.on_ethernet,
          .says_no_sample_time = settings.faults.sample_time_zero,
          .echoes_confs = settings.faults.bare_echo}
    , beam_(std::move(beam))
    , switched_on_(now)
    , alive_until_(now)
    , on_event_(std::move(on_event))
    , motor_(persona, serial, settings.faults.motor_stall, now)
    , autobaud_(starting_baud(persona, settings))
    , line_(autobaud_.baud())
    , bad_line_(settings.faults.noise, settings.faults.drop, settings.seed) {
    if (settings.faults.banner) {
        next_banner_ = now;
    }
    if (settings.faults.leftovers) {
        motor_.switch_on(now);
        start_scan(persona.modes[persona.typical_mode], false, now);
    }
}

std::uint32_t Emulator::baud() const {
    return autobaud_.baud();
}

void Emulator::take(Moment now, std::vector<Transmitted>& out) {
    const auto before = static_cast<std::ptrdiff_t>(out.size());
    if (settings_.faults.burst > 0ns) {
        take_burst(now, out);
    } else {
        line_.take(now, out);
    }
    for (auto part = out.begin() + before; part != out.end(); ++part) {
        bad_line_.damage(part->bytes);
    }
}

// An adapter that holds what it has heard until its timer ends, which never stops.
void Emulator::take_burst(Moment now, std::vector<Transmitted>& out) {
    line_.take(now, held_);
    if (now < next_burst_) {
        return;
    }
    std::move(held_.begin(), held_.end(), std::back_inserter(out));
    held_.clear();
    const std::chrono::nanoseconds burst = settings_.faults.burst;
    next_burst_ = now - (now - switched_on_) % burst + burst;
}

void Emulator::receive(std::span<const std::uint8_t> bytes, Moment now, std::uint32_t host_baud) {
    advance(now);
    listen_for_autobaud(bytes, host_baud, now);
    for (const auto byte : heard(bytes, host_baud, baud())) {
        if (const auto request = parser_.push(byte, in_microseconds(now))) {
            serve(*request, now);
        }
    }
}

// The magic bytes are recognised by their rhythm, so they are looked at as the host has sent them.
void Emulator::listen_for_autobaud(
    std::span<const std::uint8_t> bytes,
    std::uint32_t host_baud,
    Moment now
) {
    const auto info = device_info(*persona_, unit_.serial);
    if (scan_ || booted_at_ || settings_.on_ethernet || !protocol::knows_baud_negotiation(info)) {
        return;
    }
    const auto measured = autobaud_.push(bytes, host_baud != 0 ? host_baud : baud(), now);
    if (measured) {
        line_.set_baud(*measured);
        std::array<std::uint8_t, 4> answer{};  // bare, without a descriptor
        protocol::store_le32(answer, *measured);
        send(Payload::answer, answer, now + persona_->answer_time);
        on_event_({Occurrence::baud_measured});
    }
}

void Emulator::serve(const protocol::Request& request, Moment now) {
    if (command_motor(request, now)) {
        return;
    }
    if (booted_at_) {
        return;
    }
    if (scan_) {  // any other request ends a scan, and is then served
        stop_scan(now);
    } else if (line_.is_answering(now)) {
        return;  // one request at a time: others are discarded meanwhile (protocol.md 1.2)
    }
    serve_idle(request, now);
}

// Whether that was a command for the motor, whether this scanner obeys it or not.
bool Emulator::command_motor(const protocol::Request& request, Moment now) {
    const std::span<const std::uint8_t> payload(request.payload);
    const bool by_pwm = request.command == Command::set_motor_pwm;
    if (!by_pwm && request.command != Command::motor_rpm) {
        return false;
    }
    if (payload.size() < 2) {
        return true;
    }
    const auto value = protocol::load_le16(payload.first<2>());
    if (by_pwm) {
        note_motor(motor_.set_pwm(value, now));
        return true;
    }
    // 0 makes it idle (protocol.md 13.24).
    const bool obeys = persona_->motor.control == protocol::MotorControl::rpm;
    if (obeys && value == 0 && scan_) {
        stop_scan(now);
    }
    note_motor(motor_.set_rpm(value, now));
    return true;
}

void Emulator::note_motor(bool switched) {
    if (switched) {
        on_event_({motor_.is_on() ? Occurrence::motor_on : Occurrence::motor_off});
    }
}

void Emulator::serve_idle(const protocol::Request& request, Moment now) {
    if (settings_.playback != nullptr && is_scan_request(request.command)) {
        start_scan(settings_.playback->mode(), true, now);
        return;
    }
    switch (request.command) {
    case Command::scan:
    case Command::force_scan:
        start_scan(persona_->modes.front(), request.command == Command::force_scan, now);
        return;
    case Command::express_scan:
        start_express(request.payload, now);
        return;
    case Command::hq_scan:
        if (const auto* const mode = find_mode(*persona_, protocol::AnswerType::hq)) {
            start_scan(*mode, false, now);
        }
        return;
    case Command::reset:
        reset(now);
        return;
    case Command::confirm_baud:
        autobaud_.confirm(request.payload);
        line_.set_baud(baud());
        return;
    default:
        if (const auto answer = answer_to(request, *persona_, unit_)) {
            send_answer(*answer, now);
        }
    }
}

// Mode 0 is legacy express; any other is the id of a mode, and modes that SCAN starts are not
// started this way (protocol.md 2, 12).
void Emulator::start_express(std::span<const std::uint8_t> payload, Moment now) {
    constexpr std::size_t payload_size = 5;
    if (payload.size() < payload_size) {
        return;
    }
    const std::size_t id = payload[0];
    const ScanMode* chosen = nullptr;
    if (id == 0) {
        chosen = find_mode(*persona_, protocol::AnswerType::express);
    } else if (id < persona_->modes.size()) {
        chosen = &persona_->modes[id];
    }
    if (chosen != nullptr && chosen->answer != protocol::AnswerType::normal) {
        start_scan(*chosen, false, now);
    }
}

void Emulator::start_scan(const ScanMode& mode, bool forced, Moment now) {
    if (unit_.health.status == protocol::HealthStatus::error) {
        return;
    }
    send_answer(stream_descriptor(mode), now);
    scan_ = Scan{.mode = &mode, .forced = forced, .requested = now + persona_->answer_time};
    if (settings_.playback != nullptr) {
        settings_.playback->start(scan_->requested, baud());
    }
    on_event_({Occurrence::scan_started, &mode});
    note_motor(motor_.begin_scan(now));
}

void Emulator::stop_scan(Moment now) {
    line_.drop_measurements(now, bytes_beyond_recall);
    const auto* const mode = scan_->mode;
    scan_.reset();
    on_event_({Occurrence::scan_stopped, mode});
    note_motor(motor_.end_scan(now));
}

void Emulator::reset(Moment now) {
    unit_.health = settings_.faults.health;
    booted_at_ = now + persona_->boot_time;
    autobaud_.reset();
    line_.set_baud(baud());
    on_event_({Occurrence::reset});
    note_motor(motor_.reset(now));
}

void Emulator::finish_boot() {
    send(Payload::answer, bytes_of(persona_->boot_text), *booted_at_);
    booted_at_.reset();
}

// Of a scanner that prints nothing when it boots, the text of one that does.
void Emulator::print_banner(Moment now) {
    constexpr std::string_view usual_text = "RP LIDAR System.\r\n";
    const auto text = persona_->boot_text.empty() ? usual_text : persona_->boot_text;
    push(Payload::answer, bytes_of(text), now);
    next_banner_ = now + banner_period;
}

void Emulator::enter_protection_stop(std::uint16_t code, Moment now) {
    advance(now);
    if (scan_) {
        stop_scan(now);
    }
    unit_.health = {protocol::HealthStatus::error, code};
    on_event_({Occurrence::protection_stop});
}

void Emulator::advance(Moment now) {
    if (booted_at_ && *booted_at_ <= now) {
        finish_boot();
    }
    autobaud_.advance(now);
    line_.set_baud(baud());
    if (next_banner_ && *next_banner_ <= now) {
        print_banner(now);
    }
    if (scan_ && scan_->stream && now - alive_until_ > longest_catch_up) {
        scan_->stream.reset();
        scan_->requested = now;
    }
    alive_until_ = std::max(alive_until_, now);
    while (scan_ && advance_scan(now)) {
    }
}

// One step: sends a piece of the capture. Nothing of it may get lost here: what finds no room on
// the line waits.
bool Emulator::advance_playback(Moment now) {
    const auto piece = settings_.playback->piece();
    if (!piece) {
        if (!std::exchange(scan_->played_out, true)) {
            on_event_({Occurrence::played_out});
        }
        return false;
    }
    const bool silent = settings_.faults.mute || settings_.faults.banner;
    if (piece->ready > now ||
        !(silent || line_.push(Payload::measurement, piece->bytes, piece->ready) ||
          line_.push(Payload::measurement, piece->bytes, now))) {
        return false;
    }
    settings_.playback->pop();
    return true;
}

// One step: begins the stream, pauses it, or sends a packet. False when there is nothing to do yet.
bool Emulator::advance_scan(Moment now) {
    if (settings_.playback != nullptr) {
        return advance_playback(now);
    }
    auto& stream = scan_->stream;
    if (!stream) {
        return begin_stream(now);
    }
    const auto ready = stream->packet_ready();
    if (ready > now) {
        return false;
    }
    if (!scan_->forced && !motor_.motor().is_stable(stream->packet_end())) {
        stream.reset();
        return true;
    }
    send(Payload::measurement, stream->measure(motor_.motor(), beam_, switched_on_), ready);
    return true;
}

bool Emulator::begin_stream(Moment now) {
    auto begin = scan_->requested;
    if (!scan_->forced) {
        const auto stable_from = motor_.motor().stable_from();
        if (!stable_from) {
            return false;
        }
        begin = std::max(begin, *stable_from);
    }
    if (begin > now) {
        return false;
    }
    scan_->stream.emplace(*scan_->mode, motor_.motor(), begin);
    return true;
}

std::optional<Moment> Emulator::next_due() const {
    std::optional<Moment> due = line_.next_byte();
    if (!held_.empty() || (due && settings_.faults.burst > 0ns)) {
        due = next_burst_;
    }
    const auto consider = [&due](std::optional<Moment> moment) {
        if (moment && (!due || *moment < *due)) {
            due = moment;
        }
    };
    consider(booted_at_);
    consider(next_banner_);
    consider(autobaud_.trial_ends());
    if (scan_ && settings_.playback != nullptr) {
        if (const auto piece = settings_.playback->piece()) {
            consider(piece->ready);
        }
    } else if (scan_ && scan_->stream) {
        consider(scan_->stream->packet_ready());
    } else if (scan_ && !scan_->forced) {
        consider(motor_.motor().stable_from());
    }
    return due;
}

void Emulator::send_answer(std::span<const std::uint8_t> bytes, Moment now) {
    const auto ready = now + persona_->answer_time;
    if (settings_.faults.junk) {
        send(Payload::answer, junk_before_descriptor(), ready);
    }
    send(Payload::answer, bytes, ready);
}

void Emulator::send(Payload payload, std::span<const std::uint8_t> bytes, Moment ready) {
    if (settings_.faults.mute || settings_.faults.banner) {
        return;
    }
    push(payload, bytes, ready);
}

void Emulator::push(Payload payload, std::span<const std::uint8_t> bytes, Moment ready) {
    if (!line_.push(payload, bytes, ready)) {
        overrun_bytes_ += bytes.size();
    }
}

}  // namespace sweepcast::virtual_lidar
