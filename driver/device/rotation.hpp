// Rotation: how fast a lidar turns, should turn, and can be made to turn; as a value.
#pragma once

#include <cstdint>
#include <string>

namespace sweepcast::device {

/// Who sets the speed of the rotation.
enum class SpeedControl : std::uint8_t {
    fixed,  ///< nobody: it cannot be changed
    duty,   ///< the driver, by the motor's duty, from the speed it measures
    rpm,    ///< the lidar itself, told the speed
};

/// Speeds are turns a second; 0: not known.
struct Rotation {
    SpeedControl control{SpeedControl::fixed};
    /// What is aimed at: the user's wish, else the lidar's usual speed.
    double wanted_hz{};
    /// Mean of the last revolutions; 0 unless scanning.
    double measured_hz{};
    /// The measured speed is within 2 % of the wanted one, and has stopped changing.
    bool settled{};
    /// As the lidar says.
    double usual_hz{};
    double min_hz{};
    double max_hz{};
    /// Why the wish is not obeyed, and what to do, if so.
    std::string warning;
    bool operator==(const Rotation&) const = default;
};

}  // namespace sweepcast::device
