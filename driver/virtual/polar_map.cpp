#include "driver/virtual/polar_map.hpp"

#include "driver/protocol/printable.hpp"
#include "driver/virtual/error.hpp"
#include "driver/virtual/trimmed.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace {

constexpr std::string_view header = "angle_deg,distance_mm";

std::optional<double> parse_number(std::string_view text) {
    double value{};
    const auto* const end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(text.data(), end, value);
    if (failure != std::errc{} || stop != end || !std::isfinite(value)) {
        return std::nullopt;
    }
    return value;
}

// Returns the beginning of an input, for a problem that quotes it.
std::string quoted(std::string_view text) {
    constexpr std::size_t longest = 40;
    return "\"" + protocol::printable_start(text, longest, "...") + "\"";
}

// A line's point, or what is wrong with the line.
using Line = Result<PolarPoint, std::string>;

Line parse_line(std::string_view line) {
    const auto comma = line.find(',');
    if (comma == std::string_view::npos) {
        return "expected angle_deg,distance_mm, found " + quoted(line);
    }
    const auto angle_text = trimmed(line.substr(0, comma));
    const auto distance_text = trimmed(line.substr(comma + 1));
    const auto angle = parse_number(angle_text);
    if (!angle) {
        return "the angle " + quoted(angle_text) + " is not a number";
    }
    if (*angle < 0.0 || *angle >= 360.0) {
        return "the angle " + quoted(angle_text) + " is not in [0, 360) degrees";
    }
    const auto distance = parse_number(distance_text);
    if (!distance) {
        return "the distance " + quoted(distance_text) + " is not a number";
    }
    if (*distance < 0.0 || *distance > max_point_distance_mm) {
        return "the distance " + quoted(distance_text) + " is not in 0..100000 millimetres";
    }
    return PolarPoint{*angle, *distance};
}

Problem malformed(std::string_view name, std::size_t line, const std::string& what) {
    std::string where(name);
    if (line != 0) {
        where += ", line " + std::to_string(line);
    }
    return {
        errc::world_malformed,
        where + ": " + what,
        "the first line must be \"angle_deg,distance_mm\", each further line a point such as "
        "\"12.5,1830.25\"",
    };
}

// The median step from point to point: gaps, even many, do not stretch it.
double usual_spacing_deg(const std::vector<PolarPoint>& points) {
    std::vector<double> steps;
    steps.reserve(points.size());
    for (std::size_t i = 1; i < points.size(); ++i) {
        steps.push_back(points[i].angle_deg - points[i - 1].angle_deg);
    }
    if (steps.empty()) {
        return 0.0;
    }
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle;
}

}  // namespace

PolarMap::PolarMap(std::vector<PolarPoint> points) : points_(std::move(points)) {
    std::sort(points_.begin(), points_.end(), [](const PolarPoint& a, const PolarPoint& b) {
        return std::pair(a.angle_deg, a.distance_mm) < std::pair(b.angle_deg, b.distance_mm);
    });
    const auto same_angle = [](const PolarPoint& a, const PolarPoint& b) {
        return a.angle_deg == b.angle_deg;
    };
    points_.erase(std::unique(points_.begin(), points_.end(), same_angle), points_.end());
    // At least a real beam's width; and a few lone points are posts, not walls.
    constexpr double least_reach_deg = 0.1;
    constexpr double most_reach_deg = 1.0;
    reach_deg_ = std::clamp(0.6 * usual_spacing_deg(points_), least_reach_deg, most_reach_deg);
}

Result<PolarMap, Problem> PolarMap::parse(std::string_view text, std::string_view name) {
    if (text.size() > max_points_file_bytes) {
        return malformed(name, 0, "the file is larger than 16 MiB");
    }
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (text.substr(0, byte_order_mark.size()) == byte_order_mark) {
        text.remove_prefix(byte_order_mark.size());
    }
    std::vector<PolarPoint> points;
    bool header_seen = false;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const auto end = std::min(text.find('\n'), text.size());
        const auto line = trimmed(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.empty() || line.front() == '#') {
            continue;
        }
        if (!header_seen) {
            if (line != header) {
                return malformed(
                    name,
                    number,
                    "expected the header angle_deg,distance_mm, found " + quoted(line)
                );
            }
            header_seen = true;
            continue;
        }
        const auto point = parse_line(line);
        if (!point) {
            return malformed(name, number, point.error());
        }
        if (points.size() == max_points) {
            return malformed(name, number, "more than 500000 points");
        }
        if (point->distance_mm > 0.0) {
            points.push_back(*point);
        }
    }
    if (!header_seen) {
        return malformed(name, 0, "the file is empty");
    }
    if (points.empty()) {
        return malformed(name, 0, "the file has no point with an echo");
    }
    return PolarMap(std::move(points));
}

std::optional<double> PolarMap::distance_mm(double angle_deg) const {
    double angle = std::fmod(angle_deg, 360.0);
    if (angle < 0.0) {
        angle += 360.0;
    }
    const auto after = std::lower_bound(
        points_.begin(),
        points_.end(),
        angle,
        [](const PolarPoint& point, double value) { return point.angle_deg < value; }
    );
    // 359.9 and 0.1 are neighbours: the last point precedes the first, a turn earlier.
    const auto& next = after != points_.end() ? *after : points_.front();
    const auto& previous = after != points_.begin() ? *std::prev(after) : points_.back();
    const double to_next = next.angle_deg - angle + (after != points_.end() ? 0.0 : 360.0);
    const double to_previous =
        angle - previous.angle_deg + (after != points_.begin() ? 0.0 : 360.0);
    const bool take_next = to_next <= to_previous;
    if ((take_next ? to_next : to_previous) > reach_deg_) {
        return std::nullopt;
    }
    return take_next ? next.distance_mm : previous.distance_mm;
}

}  // namespace sweepcast::virtual_lidar
