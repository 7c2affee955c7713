// What follows from a scanner's model number: its name, its family, and how to treat it.
#pragma once

#include "driver/protocol/reply.hpp"

#include <cstdint>
#include <string>

namespace sweepcast::protocol {

/// The families of scanners; the letter that their names begin with.
enum class Family : std::uint8_t {
    a,  ///< triangulation
    c,
    s,
    t,
    m,  ///< this and the others but `a`: time of flight
};

/// The family of a model number. Source: protocol.md 6.
[[nodiscard]] Family family_of(std::uint8_t model);

/// The model's name as the vendor forms it, e.g. "A1M8" for 0x18. Source: protocol.md 6.
[[nodiscard]] std::string model_name(std::uint8_t model);

/// How a host controls a scanner's motor (protocol.md 5).
enum class MotorControl : std::uint8_t {
    modem_line,       ///< on and off by DTR of the USB adapter
    accessory_board,  ///< duty by SET_MOTOR_PWM
    rpm,              ///< speed by HQ_MOTOR_SPEED_CTRL
    self,             ///< spins by itself for a scan; nothing changes its speed
};

/// How the motor of `model` is controlled, as far as the model tells: for a model that may have an
/// accessory board, `accessory_board`: ask GET_ACC_BOARD_FLAG, and without one it is `modem_line`.
/// Source: protocol.md 4.1, 5.
[[nodiscard]] MotorControl motor_control_of(std::uint8_t model);

/// Whether a scanner knows GET_LIDAR_CONF: all but A models of firmware below 1.24. Source:
/// protocol.md 3.
[[nodiscard]] bool knows_lidar_conf(const DeviceInfo& info);

/// Whether a scanner knows GET_SAMPLERATE and EXPRESS_SCAN: all but A models of firmware below
/// 1.17. Source: protocol.md 2.
[[nodiscard]] bool knows_express(const DeviceInfo& info);

/// Whether a scanner can be talked into another line speed: firmware 1.30 on of A models, every
/// other family. Source: protocol.md 2, 4.7.
[[nodiscard]] bool knows_baud_negotiation(const DeviceInfo& info);

}  // namespace sweepcast::protocol
