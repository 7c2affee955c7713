// PolarMap: a world recorded as polar points, e.g. one revolution of a real scanner.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace sweepcast::virtual_lidar {

/// Limits of a file of points. Such a file may come from anywhere.
constexpr std::size_t max_points_file_bytes = 16UL << 20U;
constexpr std::size_t max_points = 500'000;
constexpr double max_point_distance_mm = 100'000.0;

struct PolarPoint {
    double angle_deg{};    ///< clockwise seen from above, [0, 360)
    double distance_mm{};  ///< > 0
    bool operator==(const PolarPoint&) const = default;
};

/// Points round the scanner. A beam gives back exactly the distance of the nearest point in angle,
/// if that is near enough; nothing is interpolated, because the straight line between two
/// neighbours may run through the air between a table leg and the wall behind it.
class PolarMap {
public:
    /// Reads text with the header `angle_deg,distance_mm` and a point a line. Blank lines and lines
    /// that begin with # are passed over; a distance of 0 says "no echo" and adds no point. Points
    /// may come in any order; of several at one angle the nearest counts, as the first thing that a
    /// beam meets. `name` is how problems call the text, usually a file name. Errors:
    /// errc::world_malformed, naming the line.
    static Result<PolarMap, Problem> parse(std::string_view text, std::string_view name);

    /// Distance in millimetres at `angle_deg` (any value, taken modulo 360). None where no point is
    /// within `reach_deg()`.
    [[nodiscard]] std::optional<double> distance_mm(double angle_deg) const;

    /// How far a point counts to either side: a little over half the usual spacing of the points,
    /// so that neighbours meet and one missing point leaves a gap.
    [[nodiscard]] double reach_deg() const { return reach_deg_; }

    /// The points, by ascending angle, one an angle.
    [[nodiscard]] const std::vector<PolarPoint>& points() const { return points_; }

private:
    explicit PolarMap(std::vector<PolarPoint> points);

    std::vector<PolarPoint> points_;
    double reach_deg_{};
};

}  // namespace sweepcast::virtual_lidar
