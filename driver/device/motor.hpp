// Motor: what makes a lidar turn, whichever way its model wants to be told.
#pragma once

#include "driver/device/conversation.hpp"
#include "driver/protocol/model.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/awaitable.hpp>

#include <cstdint>

namespace sweepcast::device {

/// Lets the motor run; `setting` as SpeedRegulator has it. Does not end a scan. Errors: those of
/// the link.
///
/// DTR is released for all: it is what starts an A1's motor, and harmless elsewhere. A line without
/// DTR (a network, a pseudo terminal) leaves a motor on the modem line to SET_MOTOR_PWM, as the
/// field's drivers send it: a board obeys it, an A1 ignores it. Source: protocol.md 5.
boost::asio::awaitable<Result<void>>
run_motor(Conversation& talk, protocol::MotorControl control, std::uint16_t setting);

/// Stops the motor, after the scan has been stopped. One that spins by itself has stopped with it.
/// Errors: those of the link.
boost::asio::awaitable<Result<void>> stop_motor(Conversation& talk, protocol::MotorControl control);

}  // namespace sweepcast::device
