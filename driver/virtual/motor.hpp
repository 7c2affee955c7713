// Motor: where the head points at any time. A function of the commands given, without steps or
// drift.
#pragma once

#include "driver/virtual/persona.hpp"

#include <chrono>
#include <optional>

namespace sweepcast::virtual_lidar {

/// A moment on the host's monotonic clock, fine enough for single bytes on the line.
using Moment = std::chrono::time_point<std::chrono::steady_clock, std::chrono::nanoseconds>;

/// Speeds up and slows down evenly, and wanders a little round its speed. Moments given to its
/// functions are not before the last command.
class Motor {
public:
    /// A motor at rest, pointing to 0 degrees, switched off.
    Motor(const MotorTraits& traits, Moment now);

    /// Makes it turn `goal_hz` times a second, from `now` on as fast as it gets there; 0 switches
    /// it off. Returns false if that was its goal already.
    bool turn_at(double goal_hz, Moment now);

    /// From `now` on it needs this long from rest to its usual speed.
    void set_spin_up(std::chrono::milliseconds spin_up, Moment now);

    [[nodiscard]] bool is_on() const { return goal_hz_ > 0.0; }

    /// Turns made by the time `at` since it was made; the part after the point is where the head
    /// points.
    [[nodiscard]] double turns(Moment at) const;

    /// Turns per second at `at`, without the ripple.
    [[nodiscard]] double rotation_hz(Moment at) const;

    /// When it is or was up to speed after it was switched on: other speeds asked for while it
    /// turns do not make it unstable. None if it is off.
    [[nodiscard]] std::optional<Moment> stable_from() const { return stable_from_; }

    /// Whether it turns steadily enough for measurements.
    [[nodiscard]] bool is_stable(Moment at) const { return stable_from_ && at >= *stable_from_; }

private:
    void count_from(Moment now);
    [[nodiscard]] double acceleration() const;  // turns per second squared, signed
    [[nodiscard]] double ramp_seconds() const;  // from the last command to an even speed
    [[nodiscard]] double even_turns(Moment at) const;

    MotorTraits traits_;
    double goal_hz_{};
    Moment commanded_;
    double hz_then_{};     // at the last command
    double turns_then_{};  // at the last command, without the ripple
    std::optional<Moment> stable_from_;
};

}  // namespace sweepcast::virtual_lidar
