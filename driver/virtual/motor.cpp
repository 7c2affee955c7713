#include "driver/virtual/motor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sweepcast::virtual_lidar {

namespace {

double seconds_between(Moment from, Moment to) {
    return std::max(0.0, std::chrono::duration<double>(to - from).count());
}

}  // namespace

Motor::Motor(const MotorTraits& traits, Moment now) : traits_(traits), commanded_(now) {}

bool Motor::turn_at(double goal_hz, Moment now) {
    if (goal_hz == goal_hz_) {
        return false;
    }
    const bool was_stable = is_stable(now);
    count_from(now);
    goal_hz_ = goal_hz;
    if (!is_on()) {
        stable_from_.reset();
    } else if (!was_stable) {
        const std::chrono::duration<double> ramp(ramp_seconds());
        stable_from_ = now + std::chrono::ceil<std::chrono::nanoseconds>(ramp);
    }
    return true;
}

void Motor::set_spin_up(std::chrono::milliseconds spin_up, Moment now) {
    if (spin_up == traits_.spin_up) {
        return;
    }
    count_from(now);
    traits_.spin_up = spin_up;
    if (stable_from_ && *stable_from_ > now) {
        const std::chrono::duration<double> ramp(ramp_seconds());
        stable_from_ = now + std::chrono::ceil<std::chrono::nanoseconds>(ramp);
    }
}

void Motor::count_from(Moment now) {
    const double turns_now = even_turns(now);
    hz_then_ = rotation_hz(now);
    turns_then_ = turns_now;
    commanded_ = now;
}

double Motor::acceleration() const {
    const bool faster = goal_hz_ > hz_then_;
    const std::chrono::duration<double> ramp(faster ? traits_.spin_up : traits_.coast_down);
    return (faster ? traits_.rotation_hz : -traits_.rotation_hz) / ramp.count();
}

double Motor::ramp_seconds() const {
    return (goal_hz_ - hz_then_) / acceleration();
}

double Motor::rotation_hz(Moment at) const {
    const double ramp = std::min(seconds_between(commanded_, at), ramp_seconds());
    return hz_then_ + acceleration() * ramp;
}

double Motor::even_turns(Moment at) const {
    const double elapsed = seconds_between(commanded_, at);
    const double ramp = std::min(elapsed, ramp_seconds());
    const double on_ramp = (hz_then_ + 0.5 * acceleration() * ramp) * ramp;
    return turns_then_ + on_ramp + goal_hz_ * (elapsed - ramp);
}

double Motor::turns(Moment at) const {
    // As a function of the angle rather than of time the ripple needs no integration, stops with
    // the motor and never turns the head back. Its period of 2.7 turns makes each revolution a
    // little different from the one before.
    constexpr double ripples_per_turn = 2.0 * std::numbers::pi / 2.7;
    const double even = even_turns(at);
    return even + traits_.ripple / ripples_per_turn * std::sin(ripples_per_turn * even);
}

}  // namespace sweepcast::virtual_lidar
