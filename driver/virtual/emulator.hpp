// Emulator: a scanner as a state machine. Bytes from the host and time go in, bytes to the host
// come out.
#pragma once

#include "driver/protocol/request_parser.hpp"
#include "driver/virtual/answers.hpp"
#include "driver/virtual/autobaud.hpp"
#include "driver/virtual/beam.hpp"
#include "driver/virtual/faults.hpp"
#include "driver/virtual/measurement_stream.hpp"
#include "driver/virtual/motor_drive.hpp"
#include "driver/virtual/persona.hpp"
#include "driver/virtual/playback.hpp"
#include "driver/virtual/transmit_line.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace sweepcast::virtual_lidar {

/// What a user would want to see in the log.
enum class Occurrence : std::uint8_t {
    motor_on,
    motor_off,
    scan_started,  ///< the request was accepted
    scan_stopped,
    reset,
    protection_stop,
    played_out,     ///< the captured scan has ended
    baud_measured,  ///< autobaud: the line has a new speed, on trial
};

struct Event {
    Occurrence what{};
    const ScanMode* mode{};  ///< of scan_started and scan_stopped
};

/// How an exemplar differs from what its persona is when new.
struct EmulatorSettings {
    Faults faults{};
    std::uint64_t seed{};  ///< of damage on the line
    bool on_ethernet{};    ///< played on a network, by a persona that has one
    /// Whatever scan is asked for, this one is played. Outlives the emulator, as does its persona.
    Playback* playback{};
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

    /// Bytes that found no room in the transmit queue, because nobody took them in time.
    [[nodiscard]] std::uint64_t overrun_bytes() const { return overrun_bytes_; }

private:
    struct Scan {
        const ScanMode* mode{};
        bool forced{};
        Moment requested;                           // no sample is taken before
        std::optional<MeasurementStream> stream{};  // none: waits for a stable rotation
        bool played_out{};
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
    void take_burst(Moment now, std::vector<Transmitted>& out);
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
    std::vector<Transmitted> held_;  // by the adapter
    Moment next_burst_{};
    protocol::RequestParser parser_;
    std::optional<Moment> booted_at_;
    std::optional<Moment> next_banner_;
    std::optional<Scan> scan_;
    std::uint64_t overrun_bytes_{};
};

}  // namespace sweepcast::virtual_lidar
