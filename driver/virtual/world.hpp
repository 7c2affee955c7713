// World: what a virtual lidar sees, either the built-in living room or a file of polar points.
#pragma once

#include "driver/protocol/result.hpp"
#include "driver/virtual/polar_map.hpp"
#include "driver/virtual/room.hpp"

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace sweepcast::virtual_lidar {

class World {
public:
    /// The built-in living room, with a person and a robot moving in it.
    static World living_room() { return World(LivingRoom{}); }

    /// A world of points that stand still.
    explicit World(PolarMap map) : world_(std::move(map)) {}

    /// Loads a file of points (see PolarMap::parse for the format).
    /// Errors: errc::world_unreadable, errc::world_malformed; the problem names file and line.
    static Result<World, Problem> load(const std::string& path);

    /// Distance in millimetres to the first thing that a beam meets at time `t`; none: no echo.
    /// `angle_deg` is in degrees, clockwise seen from above, 0 at the scanner's front; any value.
    [[nodiscard]] std::optional<double> distance_mm(double angle_deg, Seconds t) const;

private:
    struct LivingRoom {};
    explicit World(LivingRoom room) : world_(room) {}

    std::variant<LivingRoom, PolarMap> world_;
};

}  // namespace sweepcast::virtual_lidar
