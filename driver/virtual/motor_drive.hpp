// MotorDrive: what a scanner makes of the commands for its motor.
#pragma once

#include "driver/virtual/motor.hpp"
#include "driver/virtual/persona.hpp"

#include <chrono>
#include <cstdint>

namespace sweepcast::virtual_lidar {

/// How far an exemplar's motor is off the speed it should have: -1 to -0.5 or 0.5 to 1, of the most
/// that any is off. A function of its serial number.
[[nodiscard]] double deviation_of(const SerialNumber& serial);

/// Turns a second of a motor behind an accessory board at a duty of `pwm`, 0..1023 (what is above
/// counts as that). Below a tenth of the reference it stands still; from there on the speed rises,
/// less than in proportion; at the reference it is `rotation_hz`, give or take 8 % by exemplar.
[[nodiscard]] double speed_at_pwm(const Persona& persona, double deviation, std::uint16_t pwm);

/// Turns a second of a motor that was told `rpm` turns a minute: that, within the limits that the
/// scanner reports, give or take 0.4 % by exemplar; 0 for 0.
[[nodiscard]] double speed_at_rpm(const Persona& persona, double deviation, std::uint16_t rpm);

/// A motor and its controls (protocol.md 5).
///
///     control         | when it gets power | SET_MOTOR_PWM  | 0xA8  | a scan    | STOP  | RESET
///     modem line      | on                 | 0 off, else on | -     | -         | -     | -
///     accessory board | off                | speed          | -     | -         | -     | -
///     rpm             | off                | -              | speed | on if off | -     | off
///     self            | off                | -              | -     | on        | off   | off
///
/// SET_MOTOR_PWM stands in for the modem line DTR, which switches the motor of an A1 past the
/// scanner's electronics, and which neither a pseudo terminal nor a network has. That an rpm motor
/// starts for a scan, and stops in a reset, is assumed.
class MotorDrive {
public:
    /// Gives it power at `now`. `persona` outlives it. A stalled motor never turns.
    MotorDrive(const Persona& persona, const SerialNumber& serial, bool stalled, Moment now);

    // Commands. Each returns true if it has switched the motor on or off.
    bool set_pwm(std::uint16_t pwm, Moment now);
    bool set_rpm(std::uint16_t rpm, Moment now);
    bool begin_scan(Moment now);
    bool end_scan(Moment now);
    bool reset(Moment now);
    /// Something holds it: it slows down and stops, whatever it is told; or lets it go, and it does
    /// what it was told last.
    void set_stalled(bool stalled, Moment now);
    /// From `now` on it needs this long to come up to speed.
    void set_spin_up(std::chrono::milliseconds spin_up, Moment now);

    /// As a host that wants to scan would.
    bool switch_on(Moment now);

    [[nodiscard]] const Motor& motor() const { return motor_; }
    [[nodiscard]] bool is_on() const { return on_; }

private:
    bool turn_at(double hz, Moment now);

    const Persona* persona_;
    double deviation_;
    bool stalled_;
    bool on_{};
    double wanted_hz_{};
    Motor motor_;
};

}  // namespace sweepcast::virtual_lidar
