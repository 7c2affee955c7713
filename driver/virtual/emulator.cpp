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
using protocol::HealthStatus;

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

LineQuality quality_of(const Faults& faults) {
    return {.noise = faults.noise, .drop = faults.drop, .duplicate = faults.duplicate};
}

std::chrono::milliseconds spin_up_of(const Persona& persona, const Faults& faults) {
    return faults.slow_spin_up > 0ns ? faults.slow_spin_up : persona.motor.spin_up;
}

// Writes another length into the descriptor that an answer begins with.
void lie_about_length(std::span<std::uint8_t> answer, std::uint32_t length) {
    const auto field = answer.subspan<2, 4>();
    const auto mode = protocol::load_le32(field) & 0xC000'0000U;
    protocol::store_le32(field, mode | length);
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
    , line_(baud())
    , bad_line_(quality_of(settings.faults), settings.seed) {
    get_power(now);
}

void Emulator::get_power(Moment now) {
    const auto& faults = settings_.faults;
    motor_.set_spin_up(spin_up_of(*persona_, faults), now);
    if (faults.banner) {
        next_banner_ = now;
    }
    if (faults.leftovers) {
        motor_.switch_on(now);
        start_scan(persona_->modes[persona_->typical_mode], false, now);
    }
}

void Emulator::restart(const Faults& faults, Moment now) {
    settings_.faults = faults;
    scan_.reset();
    unit_.health = faults.health;
    unit_.says_no_sample_time = faults.sample_time_zero;
    unit_.echoes_confs = faults.bare_echo;
    switched_on_ = now;
    alive_until_ = now;
    motor_ = MotorDrive(*persona_, unit_.serial, faults.motor_stall, now);
    autobaud_.reset();
    line_ = TransmitLine(baud());
    bad_line_.set_quality(quality_of(faults));
    late_.clear();
    held_.clear();
    next_burst_ = now;
    parser_ = {};
    next_banner_.reset();
    halve_next_answer_ = false;
    banner_pending_ = false;
    booted_at_ = now + persona_->boot_time;
    on_event_({Occurrence::restarted});
    get_power(now);
}

void Emulator::set_faults(const Faults& faults, Moment now) {
    advance(now);
    const auto before = std::exchange(settings_.faults, faults);
    unit_.says_no_sample_time = faults.sample_time_zero;
    unit_.echoes_confs = faults.bare_echo;
    motor_.set_stalled(faults.motor_stall, now);
    motor_.set_spin_up(spin_up_of(*persona_, faults), now);
    bad_line_.set_quality(quality_of(faults));
    line_.set_baud(baud());
    for (auto& late : late_) {
        late.due = std::min(late.due, now + faults.delay);
    }
    if (faults.burst != before.burst) {
        next_burst_ = now;
    }
    if (faults.banner != before.banner) {
        next_banner_ = faults.banner ? std::optional(now) : std::nullopt;
    }
    if (faults.protection_stop_after != before.protection_stop_after) {
        plan_trip(now);
    }
    if (faults.health != before.health && faults.health.status == HealthStatus::error) {
        trip(faults.health.code, now);
    } else if (unit_.health.status != HealthStatus::error) {
        unit_.health = faults.health;
    }
    if (faults.leftovers && !before.leftovers && !scan_ && !booted_at_) {
        motor_.switch_on(now);
        start_scan(persona_->modes[persona_->typical_mode], false, now);
    }
}

bool Emulator::suffer(Incident incident, std::uint32_t value, Moment now) {
    advance(now);
    switch (incident) {
    case Incident::banner:
        banner_pending_ = scan_ && scan_->stream;
        if (!banner_pending_) {
            push(Payload::answer, bytes_of(banner()), now);
        }
        return true;
    case Incident::reboot:
        restart(settings_.faults, now);
        return true;
    case Incident::protection_stop:
        trip(static_cast<std::uint16_t>(value), now);
        return true;
    case Incident::half_answer:
        halve_next_answer_ = true;
        return true;
    case Incident::angle_restart:
        if (!scan_ || !scan_->stream) {
            return false;
        }
        scan_->stream->restart_angle();
        return true;
    case Incident::loss:
        bad_line_.lose_next(value);
        return true;
    }
    return false;
}

// Before there was one, noise that no receiver takes for anything.
std::span<const std::uint8_t> Emulator::flood_piece() const {
    return last_packet_.empty() ? junk_before_descriptor() : std::span(last_packet_);
}

bool Emulator::is_silent() const {
    return settings_.faults.mute || settings_.faults.banner;
}

std::uint32_t Emulator::baud() const {
    return settings_.faults.wrong_baud != 0 ? settings_.faults.wrong_baud : autobaud_.baud();
}

void Emulator::take(Moment now, std::vector<Transmitted>& out) {
    const auto before = static_cast<std::ptrdiff_t>(out.size());
    line_.take(now, sent_);
    for (auto& part : sent_) {
        late_.push_back({now + settings_.faults.delay, std::move(part)});
    }
    sent_.clear();
    arrive(now, out);
    for (auto part = out.begin() + before; part != out.end(); ++part) {
        damage(*part);
    }
}

// Moves to `out` what the line's delay and the adapter let through: one that has the fault holds
// what it has heard until its timer ends, which never stops.
void Emulator::arrive(Moment now, std::vector<Transmitted>& out) {
    for (; !late_.empty() && late_.front().due <= now; late_.pop_front()) {
        held_.push_back(std::move(late_.front().part));
    }
    const std::chrono::nanoseconds burst = settings_.faults.burst;
    if (burst > 0ns && now < next_burst_) {
        return;
    }
    std::move(held_.begin(), held_.end(), std::back_inserter(out));
    held_.clear();
    if (burst > 0ns) {
        next_burst_ = now - (now - switched_on_) % burst + burst;
    }
}

void Emulator::damage(Transmitted& part) {
    const bool measured = part.payload == Payload::measurement;
    if (measured && part.stream != counted_) {
        counted_ = part.stream;
        damage_count_.begin(counted_.answer);
    }
    const bool garbage = measured && settings_.faults.garbage;
    if (bad_line_.is_good() && !garbage) {
        if (measured) {
            damage_count_.pass_unchanged(part.bytes);
        } else if (part.stream == counted_ && counted_.number != 0) {
            damage_count_.insert(part.bytes);
        }
        return;
    }
    damaged_.clear();
    for (const auto byte : part.bytes) {
        const auto arrived_before = damaged_.size();
        if (garbage) {
            bad_line_.change(byte, damaged_);
        } else {
            bad_line_.pass(byte, damaged_);
        }
        const auto arrived = std::span(damaged_).subspan(arrived_before);
        if (measured) {
            damage_count_.pass(byte, arrived);
        } else if (part.stream == counted_ && counted_.number != 0) {
            damage_count_.insert(arrived);
        }
    }
    part.bytes = damaged_;
}

void Emulator::receive(std::span<const std::uint8_t> bytes, Moment now, std::uint32_t host_baud) {
    advance(now);
    if (settings_.faults.deaf) {
        return;
    }
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
    scan_ = Scan{
        .mode = &mode,
        .forced = forced,
        .requested = now + persona_->answer_time,
        .id = {++streams_, mode.answer}};
    plan_trip(now);
    if (settings_.playback != nullptr) {
        settings_.playback->start(scan_->requested, baud());
    }
    on_event_({Occurrence::scan_started, &mode});
    note_motor(motor_.begin_scan(now));
}

// A scan ends so long after this moment, if that is its fault.
void Emulator::plan_trip(Moment from) {
    const auto after = settings_.faults.protection_stop_after;
    if (scan_) {
        scan_->trips_at = after > 0ns ? std::optional(from + after) : std::nullopt;
    }
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
std::string_view Emulator::banner() const {
    constexpr std::string_view usual_text = "RP LIDAR System.\r\n";
    return persona_->boot_text.empty() ? usual_text : persona_->boot_text;
}

void Emulator::print_banner(Moment now) {
    push(Payload::answer, bytes_of(banner()), now);
    next_banner_ = now + banner_period;
}

void Emulator::enter_protection_stop(std::uint16_t code, Moment now) {
    advance(now);
    trip(code, now);
}

void Emulator::trip(std::uint16_t code, Moment now) {
    if (scan_) {
        stop_scan(now);
    }
    unit_.health = {HealthStatus::error, code};
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
    if (scan_ && scan_->trips_at && *scan_->trips_at <= now) {
        trip(usual_health_code, now);
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
    if (piece->ready > now ||
        !(is_silent() || line_.push(Payload::measurement, piece->bytes, piece->ready, scan_->id) ||
          line_.push(Payload::measurement, piece->bytes, now, scan_->id))) {
        return false;
    }
    if (settings_.on_measured) {
        settings_.on_measured({scan_->id, piece->ready, piece->bytes});
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
    const bool forced = scan_->forced || settings_.faults.forced;
    if (!forced && !motor_.motor().is_stable(stream->packet_end())) {
        stream.reset();
        return true;
    }
    send_measured(stream->measure(motor_.motor(), beam_, switched_on_), ready);
    return true;
}

bool Emulator::begin_stream(Moment now) {
    auto begin = scan_->requested;
    if (!scan_->forced && !settings_.faults.forced) {
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
    if (!late_.empty() && (!due || late_.front().due < *due)) {
        due = late_.front().due;
    }
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
    consider(scan_ ? scan_->trips_at : std::nullopt);
    if (scan_ && settings_.playback != nullptr) {
        if (const auto piece = settings_.playback->piece()) {
            consider(piece->ready);
        }
    } else if (scan_ && scan_->stream) {
        consider(scan_->stream->packet_ready());
    } else if (scan_ && !scan_->forced && !settings_.faults.forced) {
        consider(motor_.motor().stable_from());
    }
    return due;
}

void Emulator::send_answer(std::span<const std::uint8_t> bytes, Moment now) {
    const auto ready = now + persona_->answer_time;
    if (settings_.faults.junk) {
        send(Payload::answer, junk_before_descriptor(), ready);
    }
    std::vector<std::uint8_t> answer(bytes.begin(), bytes.end());
    if (settings_.faults.lying_length) {
        lie_about_length(answer, *settings_.faults.lying_length);
    }
    if (std::exchange(halve_next_answer_, false) || settings_.faults.half_answers) {
        answer.resize(answer.size() / 2);
    }
    send(Payload::answer, answer, ready);
}

void Emulator::send_measured(std::span<const std::uint8_t> bytes, Moment ready) {
    if (settings_.on_measured) {
        settings_.on_measured({scan_->id, ready, bytes});
    }
    last_packet_.assign(bytes.begin(), bytes.end());
    if (!std::exchange(banner_pending_, false)) {
        send(Payload::measurement, bytes, ready);
        return;
    }
    const auto half = bytes.size() / 2;
    send(Payload::measurement, bytes.first(half), ready);
    push(Payload::answer, bytes_of(banner()), ready);
    send(Payload::measurement, bytes.subspan(half), ready);
}

void Emulator::send(Payload payload, std::span<const std::uint8_t> bytes, Moment ready) {
    if (!is_silent()) {
        push(payload, bytes, ready);
    }
}

void Emulator::push(Payload payload, std::span<const std::uint8_t> bytes, Moment ready) {
    if (!line_.push(payload, bytes, ready, scan_ ? scan_->id : StreamId{})) {
        overrun_bytes_ += bytes.size();
    }
}

}  // namespace sweepcast::virtual_lidar
