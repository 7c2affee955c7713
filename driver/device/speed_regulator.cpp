#include "driver/device/speed_regulator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sweepcast::device {

namespace {

constexpr double close_enough = 0.005;
/// Below this no motor turns; a regulator that gets here could not come back.
constexpr double least_duty = 60.0;
/// A speed that is steady but not met after so many revolutions will not be.
constexpr std::uint32_t patience = 60;

std::uint16_t to_setting(double value, double least, double most) {
    return static_cast<std::uint16_t>(std::lround(std::clamp(value, least, most)));
}

}  // namespace

void SpeedRegulator::want(double hz) {
    wish_hz_ = hz;
    since_wish_ = 0;
    since_setting_ = 0;
    settled_ = false;
    failed_at_hz_ = 0;
    switch (speed_control(traits_.control)) {
    case SpeedControl::fixed:
        wanted_hz_ = wish_hz_;
        setting_ = 0;
        return;
    case SpeedControl::rpm:
        wanted_hz_ = wish_hz_ > 0 ? wish_hz_ : usual_hz();
        setting_ = to_setting(wanted_hz_ * 60.0, 1.0, 0xFFFF);
        return;
    case SpeedControl::duty: {
        wanted_hz_ = wish_hz_ > 0 ? wish_hz_ : usual_hz();
        const double share = usual_hz() > 0 ? wanted_hz_ / usual_hz() : 1.0;
        setting_ = to_setting(traits_.desired.pwm * share, least_duty, full_duty);
        return;
    }
    }
}

void SpeedRegulator::observe(std::chrono::microseconds revolution) {
    speed_.add(revolution);
    since_wish_ = std::min(since_wish_ + 1, patience);
    since_setting_ = std::min(since_setting_ + 1, patience);
    // A speed that only passes the wanted one on its way to another is not settled.
    settled_ = speed_is_met(speed_.hz(), wanted_hz_) && (settled_ || steady());
    if (speed_control(traits_.control) == SpeedControl::duty && steady()) {
        correct();
    }
    note_failure();
}

void SpeedRegulator::stopped() {
    speed_.forget();
    since_wish_ = 0;
    since_setting_ = 0;
    settled_ = false;
    failed_at_hz_ = 0;
}

/// Whether the motor turns as it was told and no longer changes its speed.
bool SpeedRegulator::steady() const {
    return since_setting_ >= Speedometer::most && speed_.steady();
}

void SpeedRegulator::correct() {
    const double ratio = wanted_hz_ / speed_.hz();
    const auto better = to_setting(setting_ * ratio, least_duty, full_duty);
    if (std::abs(ratio - 1.0) > close_enough && better != setting_) {
        setting_ = better;
        since_setting_ = 0;
        failed_at_hz_ = 0;
    }
}

/// Notes that the speed will not become the wanted one. What is noted stays until the speed really
/// is another one, so that jitter does not make news of it.
void SpeedRegulator::note_failure() {
    if (speed_is_met(speed_.hz(), wanted_hz_)) {
        failed_at_hz_ = 0;
    } else if (since_wish_ >= patience && steady() && !speed_is_met(speed_.hz(), failed_at_hz_)) {
        failed_at_hz_ = speed_.hz();
    }
}

std::string SpeedRegulator::warning() const {
    const auto control = speed_control(traits_.control);
    if (control == SpeedControl::fixed) {
        return wish_hz_ > 0
                   ? "the speed of this lidar cannot be changed: it turns as fast as it does"
                   : "";
    }
    const bool beyond = (traits_.min_rpm > 0 && wanted_hz_ * 60.0 < traits_.min_rpm) ||
                        (traits_.max_rpm > 0 && wanted_hz_ * 60.0 > traits_.max_rpm);
    const bool failed = failed_at_hz_ > 0;
    if (failed && control == SpeedControl::duty && setting_ == full_duty) {
        return fmt::format(
            "the motor does not reach {:.1f} Hz even at full duty: check its 5 V supply, or want "
            "less",
            wanted_hz_
        );
    }
    if (failed) {
        return fmt::format(
            "the lidar was told {:.1f} Hz but turns at {:.1f}: want a speed within its range, and "
            "see "
            "that nothing brakes it",
            wanted_hz_,
            failed_at_hz_
        );
    }
    if (beyond) {
        return fmt::format(
            "{:.1f} Hz is beyond the {:.1f} to {:.1f} Hz that the lidar is made for",
            wanted_hz_,
            traits_.min_rpm / 60.0,
            traits_.max_rpm / 60.0
        );
    }
    return "";
}

Rotation SpeedRegulator::rotation() const {
    const bool usual_is_known = speed_control(traits_.control) != SpeedControl::fixed;
    return {
        .control = speed_control(traits_.control),
        .wanted_hz = wanted_hz_,
        .measured_hz = speed_.hz(),
        .settled = settled_,
        .usual_hz = usual_is_known ? usual_hz() : 0.0,
        .min_hz = usual_is_known ? traits_.min_rpm / 60.0 : 0.0,
        .max_hz = usual_is_known ? traits_.max_rpm / 60.0 : 0.0,
        .warning = warning()};
}

}  // namespace sweepcast::device
