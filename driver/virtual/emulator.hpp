// Emulator: a scanner as a state machine. Bytes from the host and time go in, bytes to the host
// come out.
#pragma once

#include "driver/protocol/request_parser.hpp"
#include "driver/virtual/answers.hpp"
#include "driver/virtual/autobaud.hpp"
#include "driver/virtual/bad_line.hpp"
#include "driver/virtual/beam.hpp"
#include "driver/virtual/damage_count.hpp"
#include "driver/virtual/faults.hpp"
#include "driver/virtual/measurement_stream.hpp"
#include "driver/virtual/motor_drive.hpp"
#include "driver/virtual/persona.hpp"
#include "driver/virtual/playback.hpp"
#include "driver/virtual/transmit_line.hpp"

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace sweepcast::virtual_lidar {

/// What a user would want to see in the log.
enum class Occurrence : std::uint8_t {
    motor_on,
    motor_off,
    scan_started,  ///< the request was accepted
    scan_stopped,
    reset,
    restarted,  ///< it lost its power and has it again
    protection_stop,
    played_out,     ///< the captured scan has ended
    baud_measured,  ///< autobaud: the line has a new speed, on trial
};

struct Event {
    Occurrence what{};
    const ScanMode* mode{};  ///< of scan_started and scan_stopped
};

/// What happens to a scanner once, as opposed to a fault, which lasts.
enum class Incident : std::uint8_t {
    banner,           ///< it prints its boot text, in the midst of a packet if it is scanning
    reboot,           ///< its power fails for a moment
    protection_stop,  ///< with the value as its code, until RESET
    half_answer,      ///< of its next answer it sends the first half only
    angle_restart,    ///< it finds its angle reference anew
    loss,             ///< the next bytes to the host are lost, as many as the value says
};

/// Measurements as the scanner made them, before anything happened to them.
struct Measured {
    StreamId stream;
    Moment ready;  ///< to be sent
    /// A packet; of a capture that is played any piece of the stream. Valid during the call.
    std::span<const std::uint8_t> bytes;
};

/// How an exemplar differs from what its persona is when new.
struct EmulatorSettings {
    Faults faults{};
    std::uint64_t seed{};  ///< of damage on the line
    bool on_ethernet{};    ///< played on a network, by a persona that has one
    /// Whatever scan is asked for, this one is played. Outlives the emulator, as does its persona.
    Playback* playback{};
    /// Told of every packet when it is complete, also of those that then find no room on the line,
    /// or are not sent because of a fault. May be empty.
    std::function<void(const Measured&)> on_measured{};
};

/// A scanner from the moment it gets power. It behaves as protocol.md 11 and 14 say:
///
///     state            | SCAN, EXPRESS_SCAN, FORCE_SCAN | STOP    | RESET   | other requests
///     idle             | scanning                       | -       | booting | answered
///     scanning         | scanning anew                  | idle    | booting | idle, answered
///     protection stop  | -                              | -       | booting | answered
///     booting          | -                              | -       | -       | -
///
/// Motor commands are obeyed in every state (see MotorDrive) and change none, but for 0xA8 with 0,
/// which makes a scanner that knows it idle. While the motor is off or not up to speed a scan
/// pauses, unless it was forced.
///
/// Line speed: bytes from a host of another speed arrive as a UART would hear them; for those to
/// the host that is the caller's, who knows how the host listens.
///
/// Times given to its functions never go back. After each call that takes a time, take() what is
/// due.
class Emulator {
public:
    using OnEvent = std::function<void(const Event&)>;

    /// Switches the scanner on at `now`. `persona` outlives it.
    Emulator(
        const Persona& persona,
        const SerialNumber& serial,
        Beam beam,
        Moment now,
        OnEvent on_event,
        const EmulatorSettings& settings = {}
    );

    /// Takes bytes that the host sent at `host_baud` (0: at the scanner's own speed), received at
    /// `now`.
    void receive(std::span<const std::uint8_t> bytes, Moment now, std::uint32_t host_baud = 0);

    /// Lives on until `now`: measures, boots. If more than 0.3 s have passed since the last call
    /// (the process was stopped), a running scan goes on from `now` with a restart instead of
    /// catching up.
    void advance(Moment now);

    /// Appends to `out` what the line has carried to the host by `now`.
    void take(Moment now, std::vector<Transmitted>& out);

    /// Bits a second that it sends and listens at.
    [[nodiscard]] std::uint32_t baud() const;

    /// When there will be something to do next; none if only the host can change anything.
    [[nodiscard]] std::optional<Moment> next_due() const;

    /// A hardware fault: stops the scan and reports `code` until RESET.
    void enter_protection_stop(std::uint16_t code, Moment now);

    /// It had no power for a while and gets it again at `now`: it boots, and remembers nothing.
    void restart(const Faults& faults, Moment now);

    /// Which faults it has from `now` on, in place of those it had. What has come to rest because
    /// of a fault goes on when that is gone; a protection stop lasts until RESET all the same.
    void set_faults(const Faults& faults, Moment now);
    [[nodiscard]] const Faults& faults() const { return settings_.faults; }

    /// Lets this happen at `now`. False if it could not: no scan runs whose angle could restart.
    bool suffer(Incident incident, std::uint32_t value, Moment now);

    [[nodiscard]] const SerialNumber& serial() const { return unit_.serial; }

    /// The mode of the scan that runs; null if none does.
    [[nodiscard]] const ScanMode* scan_mode() const { return scan_ ? scan_->mode : nullptr; }

    /// What is sent over and over by a scanner with the fault `flood`: its last packet.
    [[nodiscard]] std::span<const std::uint8_t> flood_piece() const;

    /// What the line did to the measurement bytes that take() gave.
    [[nodiscard]] const DamageCounters& damage() const { return damage_count_.counters(); }

    /// Bytes that found no room in the transmit queue, because nobody took them in time.
    [[nodiscard]] std::uint64_t overrun_bytes() const { return overrun_bytes_; }

private:
    struct Scan {
        const ScanMode* mode{};
        bool forced{};
        Moment requested;                           // no sample is taken before
        std::optional<MeasurementStream> stream{};  // none: waits for a stable rotation
        bool played_out{};
        StreamId id{};
        std::optional<Moment> trips_at{};  // and ends in a protection stop
    };
    struct Late {
        Moment due;
        Transmitted part;
    };

    void serve(const protocol::Request& request, Moment now);
    void serve_idle(const protocol::Request& request, Moment now);
    void start_express(std::span<const std::uint8_t> payload, Moment now);
    void start_scan(const ScanMode& mode, bool forced, Moment now);
    void stop_scan(Moment now);
    void reset(Moment now);
    void finish_boot();
    void print_banner(Moment now);
    bool command_motor(const protocol::Request& request, Moment now);
    void note_motor(bool switched);
    void
    listen_for_autobaud(std::span<const std::uint8_t> bytes, std::uint32_t host_baud, Moment now);
    void get_power(Moment now);
    void trip(std::uint16_t code, Moment now);
    void plan_trip(Moment from);
    void arrive(Moment now, std::vector<Transmitted>& out);
    void damage(Transmitted& part);
    void send_measured(std::span<const std::uint8_t> bytes, Moment ready);
    [[nodiscard]] bool is_silent() const;
    [[nodiscard]] std::string_view banner() const;
    bool advance_scan(Moment now);
    bool advance_playback(Moment now);
    bool begin_stream(Moment now);
    void send_answer(std::span<const std::uint8_t> bytes, Moment now);
    void send(Payload payload, std::span<const std::uint8_t> bytes, Moment ready);
    void push(Payload payload, std::span<const std::uint8_t> bytes, Moment ready);

    const Persona* persona_;
    EmulatorSettings settings_;
    Unit unit_;
    Beam beam_;
    Moment switched_on_;
    Moment alive_until_;
    OnEvent on_event_;
    MotorDrive motor_;
    Autobaud autobaud_;
    TransmitLine line_;
    BadLine bad_line_;
    DamageCount damage_count_;
    StreamId counted_{};                 // by it
    std::vector<std::uint8_t> damaged_;  // what arrives of a part
    std::vector<Transmitted> sent_;
    std::deque<Late> late_;
    std::vector<Transmitted> held_;  // by the adapter
    Moment next_burst_{};
    protocol::RequestParser parser_;
    std::optional<Moment> booted_at_;
    std::optional<Moment> next_banner_;
    std::optional<Scan> scan_;
    std::uint32_t streams_{};
    std::vector<std::uint8_t> last_packet_;
    bool halve_next_answer_{};
    bool banner_pending_{};
    std::uint64_t overrun_bytes_{};
};

}  // namespace sweepcast::virtual_lidar
