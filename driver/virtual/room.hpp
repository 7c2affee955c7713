// Room: the built-in world, a furnished living room in which a person and a robot go their rounds.
#pragma once

#include <chrono>
#include <optional>

namespace sweepcast::virtual_lidar {

/// Seconds since the virtual lidar was switched on.
using Seconds = std::chrono::duration<double>;

/// Distance in millimetres from the scanner to the first thing that a beam meets in the living
/// room. `angle_deg` is in degrees, clockwise seen from above, 0 at the scanner's front; any value.
/// None if the beam leaves through the open end of the corridor.
std::optional<double> living_room_distance_mm(double angle_deg, Seconds t);

}  // namespace sweepcast::virtual_lidar
