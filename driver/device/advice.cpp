#include "driver/device/advice.hpp"

#include "driver/device/error.hpp"
#include "driver/link/error.hpp"

#include <fmt/format.h>

#include <string>

namespace sweepcast::device {

namespace {

std::string_view next_step_after(error_code code) {
    if (code == errc::no_answer) {
        return "check the lidar's power and cable, and that the port really is its own";
    }
    if (code == errc::stream_silent) {
        return "check that the motor turns: it needs a good 5 V supply and must not be blocked";
    }
    if (code == errc::not_turning) {
        return "see that nothing blocks the motor, that its belt is on, and that the line does not "
               "lose most of what it carries";
    }
    if (code == errc::protection_stop) {
        return "see that nothing blocks the lidar, then reset it; if this comes back, it is broken";
    }
    if (code == errc::another_lidar) {
        return "the one that was there is looked for elsewhere; if it is nowhere, this one takes "
               "its place";
    }
    if (code == errc::superseded) {
        return "look at the lidar's state";
    }
    if (code == link::errc::disconnected) {
        return "check the USB cable and plug the lidar in again; on a network: its power, address "
               "and port";
    }
    return "";
}

}  // namespace

Problem advice(error_code code) {
    return {code, code.message(), std::string(next_step_after(code))};
}

Problem protection_problem(std::uint16_t code) {
    auto problem = advice(errc::protection_stop);
    problem.cause += fmt::format(", error code {} (0x{:04X})", code, code);
    return problem;
}

Problem reset_in_vain(std::size_t resets, std::uint16_t code) {
    auto problem = protection_problem(code);
    problem.cause += fmt::format(", and {} resets have not helped", resets);
    problem.hint =
        "see that nothing blocks its motor and that its 5 V supply is good, then reset it; if that "
        "does not help, unplug it for ten seconds; if it comes back then, the lidar is broken";
    return problem;
}

Problem unwatched() {
    return {{}, "nobody watches, so its motor is off", "it scans for the first who subscribes"};
}

bool is_absence(const error_code& code) {
    return code == link::errc::port_not_found;
}

Problem still_pending(Phase phase) {
    return {
        make_error_code(errc::pending),
        "the lidar is still " + std::string(name(phase)),
        "the command is kept; the lidar's state shows when it has taken effect"};
}

std::optional<Problem> speed_problem(double hz, const MotorTraits& motor, bool is_known) {
    constexpr double most_hz = 50.0;
    if (!(hz >= 0.0 && hz <= most_hz)) {  // written so that NaN is refused
        return Problem{
            make_error_code(errc::no_such_speed),
            fmt::format("no lidar turns at {} Hz", hz),
            "give turns a second, such as 7, or 0 for the lidar's usual speed"};
    }
    if (!is_known || hz == 0.0) {
        return std::nullopt;
    }
    if (speed_control(motor.control) == SpeedControl::fixed) {
        return Problem{
            make_error_code(errc::fixed_speed),
            make_error_code(errc::fixed_speed).message(),
            "its motor has no control that a host could use; 0 withdraws the wish"};
    }
    if (motor.max_rpm > 0 && (hz * 60.0 < motor.min_rpm || hz * 60.0 > motor.max_rpm)) {
        return Problem{
            make_error_code(errc::no_such_speed),
            fmt::format("this lidar is not made for {} Hz", hz),
            fmt::format(
                "give turns a second from {:.1f} to {:.1f}, or 0 for its usual {:.1f}",
                motor.min_rpm / 60.0,
                motor.max_rpm / 60.0,
                motor.desired.rpm / 60.0
            )};
    }
    return std::nullopt;
}

Problem unknown_mode(std::string_view name, const std::vector<ScanMode>& modes) {
    std::string names;
    for (const auto& mode : modes) {
        names += (names.empty() ? "" : ", ") + mode.name;
    }
    return {
        make_error_code(errc::unknown_mode),
        "no scan mode \"" + std::string(name) + "\"",
        "this lidar has: " + names};
}

}  // namespace sweepcast::device
