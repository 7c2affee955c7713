// Advice: turns the errors of a lidar's life into what an operator should read.
#pragma once

#include "driver/device/device_state.hpp"
#include "driver/device/motor_traits.hpp"
#include "driver/device/scan_mode.hpp"
#include "driver/protocol/result.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace sweepcast::device {

/// The cause in words and the next step, for any error of the device and of its link.
[[nodiscard]] Problem advice(error_code code);

/// The lidar says that it is in protection stop, for the reason that its maker gave that code.
[[nodiscard]] Problem protection_problem(std::uint16_t code);

/// It is in protection stop still, though it was reset so many times.
[[nodiscard]] Problem reset_in_vain(std::size_t resets, std::uint16_t code);

/// It would scan if anybody watched.
[[nodiscard]] Problem unwatched();

/// Whether the code says that the port itself is not there, so that its coming is worth waiting
/// for.
[[nodiscard]] bool is_absence(const error_code& code);

/// Returns that a command is kept but has not taken effect in time: the lidar is still in `phase`.
[[nodiscard]] Problem still_pending(Phase phase);

/// What is wrong with the wish to turn at `hz` turns a second (0: the usual speed), if anything.
/// What the motor cannot do counts once the lidar `is_known`.
[[nodiscard]] std::optional<Problem>
speed_problem(double hz, const MotorTraits& motor, bool is_known);

/// There is no scan mode called `name`; names those there are.
[[nodiscard]] Problem unknown_mode(std::string_view name, const std::vector<ScanMode>& modes);

}  // namespace sweepcast::device
