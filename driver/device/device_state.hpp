// DeviceState: how a lidar is right now, as a value that others can keep and compare.
#pragma once

#include "driver/device/line_quality.hpp"
#include "driver/device/rotation.hpp"
#include "driver/device/scan_mode.hpp"
#include "driver/protocol/reply.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::device {

enum class Phase {
    disconnected,     ///< the gateway has not opened the port, or closed it at the end
    identifying,      ///< asking who and how it is
    idle,             ///< ready, motor off
    starting,         ///< motor on, waiting for the first samples
    scanning,         ///< samples are coming in
    stopping,         ///< ending the scan, motor going off
    protection_stop,  ///< the lidar switched itself off: only a reset helps
    failed,           ///< see cause; tried again by itself
};

[[nodiscard]] std::string_view name(Phase phase);

struct DeviceState {
    Phase phase{Phase::disconnected};
    std::chrono::system_clock::time_point since{};
    /// Why it is in this phase, if that needs saying, and what to do about it.
    std::string cause;
    std::string hint;

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
