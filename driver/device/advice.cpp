#include "driver/device/advice.hpp"

#include "driver/device/error.hpp"
#include "driver/link/error.hpp"

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
    if (code == errc::protection_stop) {
        return "see that nothing blocks the lidar, then reset it; if this comes back, it is broken";
    }
    if (code == errc::superseded) {
        return "look at the lidar's state";
    }
    if (code == link::errc::disconnected) {
        return "check the USB cable and plug the lidar in again";
    }
    return "";
}

}  // namespace

Problem advice(error_code code) {
    return {code, code.message(), std::string(next_step_after(code))};
}

Problem not_ready(Phase phase) {
    return {
        make_error_code(errc::not_ready),
        "the lidar is still " + std::string(name(phase)),
        "the command stays in force; its state tells when it has taken effect"};
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
