#include "driver/virtual/motor_drive.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::virtual_lidar {

using protocol::MotorControl;

double deviation_of(const SerialNumber& serial) {
    const int number = serial[0] ^ serial[7] ^ serial[15];
    const double part = 0.5 + (number >> 1) / 254.0;  // 7 bits
    return (number & 1) != 0 ? part : -part;
}

double speed_at_pwm(const Persona& persona, double deviation, std::uint16_t pwm) {
    constexpr std::uint16_t most_pwm = 1023;
    constexpr double friction = 0.1;  // of the reference, before anything moves
    constexpr double bend = 0.12;
    constexpr double most_deviation = 0.08;
    const double duty =
        std::min(pwm, most_pwm) / static_cast<double>(persona.rotation.pwm_reference);
    const double force = std::max(0.0, (duty - friction) / (1.0 - friction));
    const double part = force * (1.0 + bend * (1.0 - force));
    return persona.motor.rotation_hz * part * (1.0 + most_deviation * deviation);
}

double speed_at_rpm(const Persona& persona, double deviation, std::uint16_t rpm) {
    constexpr double most_deviation = 0.004;
    if (rpm == 0) {
        return 0.0;
    }
    const auto possible = std::clamp(rpm, persona.rotation.min_rpm, persona.rotation.max_rpm);
    return possible / 60.0 * (1.0 + most_deviation * deviation);
}

MotorDrive::MotorDrive(const Persona& persona, const SerialNumber& serial, bool stalled, Moment now)
    : persona_(&persona)
    , deviation_(deviation_of(serial))
    , stalled_(stalled)
    , motor_(persona.motor, now) {
    if (persona.motor.control == MotorControl::modem_line) {
        switch_on(now);
    }
}

bool MotorDrive::turn_at(double hz, Moment now) {
    const bool was_on = std::exchange(on_, hz > 0.0);
    wanted_hz_ = hz;
    motor_.turn_at(stalled_ ? 0.0 : hz, now);
    return on_ != was_on;
}

void MotorDrive::set_stalled(bool stalled, Moment now) {
    stalled_ = stalled;
    turn_at(wanted_hz_, now);
}

void MotorDrive::set_spin_up(std::chrono::milliseconds spin_up, Moment now) {
    motor_.set_spin_up(spin_up, now);
}

bool MotorDrive::set_pwm(std::uint16_t pwm, Moment now) {
    switch (persona_->motor.control) {
    case MotorControl::modem_line:
        return turn_at(pwm != 0 ? persona_->motor.rotation_hz : 0.0, now);
    case MotorControl::accessory_board:
        return turn_at(speed_at_pwm(*persona_, deviation_, pwm), now);
    default:
        return false;
    }
}

bool MotorDrive::set_rpm(std::uint16_t rpm, Moment now) {
    return persona_->motor.control == MotorControl::rpm &&
           turn_at(speed_at_rpm(*persona_, deviation_, rpm), now);
}

bool MotorDrive::begin_scan(Moment now) {
    const auto control = persona_->motor.control;
    const bool starts_it =
        control == MotorControl::self || (control == MotorControl::rpm && !is_on());
    return starts_it && switch_on(now);
}

bool MotorDrive::end_scan(Moment now) {
    return persona_->motor.control == MotorControl::self && turn_at(0.0, now);
}

bool MotorDrive::reset(Moment now) {
    const auto control = persona_->motor.control;
    const bool stops_it = control == MotorControl::self || control == MotorControl::rpm;
    return stops_it && turn_at(0.0, now);
}

bool MotorDrive::switch_on(Moment now) {
    const auto& rotation = persona_->rotation;
    switch (persona_->motor.control) {
    case MotorControl::accessory_board:
        return set_pwm(rotation.pwm_reference, now);
    case MotorControl::rpm:
        return set_rpm(rotation.desired_rpm, now);
    default:
        return turn_at(persona_->motor.rotation_hz, now);
    }
}

}  // namespace sweepcast::virtual_lidar
