// DeviceState: how a lidar is right now, as a value that others can keep and compare.
#pragma once

#include "driver/device/life.hpp"
#include "driver/device/line_quality.hpp"
#include "driver/device/rotation.hpp"
#include "driver/device/scan_mode.hpp"
#include "driver/protocol/reply.hpp"

#include <optional>
#include <string>
#include <vector>

namespace sweepcast::device {

struct DeviceState : Life {
    /// Unset until identified.
    std::optional<protocol::DeviceInfo> info;
    std::optional<protocol::Health> health;
    std::vector<ScanMode> modes;
    /// Name of the mode in use, or of the one for the next start.
    std::string mode;
    /// The name its maker gave this very model, e.g. "A3M1-R1"; empty if it has none.
    std::string alias;
    Rotation rotation;
    LineQuality line;
};

}  // namespace sweepcast::device
