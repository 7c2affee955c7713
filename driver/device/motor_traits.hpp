// MotorTraits: what a lidar says of its motor.
#pragma once

#include "driver/device/rotation.hpp"
#include "driver/protocol/lidar_conf.hpp"
#include "driver/protocol/model.hpp"

#include <cstdint>

namespace sweepcast::device {

struct MotorTraits {
    protocol::MotorControl control{protocol::MotorControl::modem_line};
    /// Where the lidar does not say: the vendor's usual 600 rpm, 660 of 1023 (protocol.md 5).
    protocol::DesiredRotation desired{600, 660};
    /// 0: the lidar does not say.
    std::uint16_t min_rpm{};
    std::uint16_t max_rpm{};
    bool operator==(const MotorTraits&) const = default;
};

/// Who sets the speed of such a motor.
[[nodiscard]] constexpr SpeedControl speed_control(protocol::MotorControl control) {
    switch (control) {
    case protocol::MotorControl::accessory_board:
        return SpeedControl::duty;
    case protocol::MotorControl::rpm:
        return SpeedControl::rpm;
    case protocol::MotorControl::modem_line:
    case protocol::MotorControl::self:
        break;
    }
    return SpeedControl::fixed;
}

}  // namespace sweepcast::device
