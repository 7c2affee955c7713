#include "driver/virtual/room.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace sweepcast::virtual_lidar {

namespace {

// The scanner stands at (0, 0). x points to its front, y to its right: clockwise angles then turn
// from x to y, as in mathematics. All in millimetres.
struct Point {
    double x{};
    double y{};
};
struct Wall {
    Point from;
    Point to;
};
struct Disc {
    Point centre;
    double radius{};
};

constexpr std::array walls{
    // The room, from its front left corner: a bay window in front, a door at the back on the right.
    Wall{{3100, -1700}, {3100, 600}},
    Wall{{3100, 600}, {3600, 600}},
    Wall{{3600, 600}, {3600, 1800}},
    Wall{{3600, 1800}, {3100, 1800}},
    Wall{{3100, 1800}, {3100, 2400}},
    Wall{{3100, 2400}, {-2100, 2400}},
    Wall{{-2100, 2400}, {-2100, 900}},
    Wall{{-2100, 0}, {-2100, -1700}},
    Wall{{-2100, -1700}, {3100, -1700}},
    // The corridor behind the door has no end: beams that go down it bring nothing back.
    Wall{{-2100, 900}, {-14000, 900}},
    Wall{{-2100, 0}, {-14000, 0}},
    // A sofa on the left wall.
    Wall{{-900, -1700}, {-900, -850}},
    Wall{{-900, -850}, {1100, -850}},
    Wall{{1100, -850}, {1100, -1700}},
    // A cupboard on the right wall.
    Wall{{-1500, 2400}, {-1500, 1900}},
    Wall{{-1500, 1900}, {-300, 1900}},
    Wall{{-300, 1900}, {-300, 2400}},
};

constexpr std::array still_discs{
    // The legs of a table, and a plant.
    Disc{{900, 700}, 30},
    Disc{{1700, 700}, 30},
    Disc{{1700, 1500}, 30},
    Disc{{900, 1500}, 30},
    Disc{{2700, -1300}, 180},
};

constexpr double infinity = std::numeric_limits<double>::infinity();

double cross(Point a, Point b) {
    return a.x * b.y - a.y * b.x;
}
double dot(Point a, Point b) {
    return a.x * b.x + a.y * b.y;
}
Point operator-(Point a, Point b) {
    return {a.x - b.x, a.y - b.y};
}
Point operator+(Point a, Point b) {
    return {a.x + b.x, a.y + b.y};
}
Point operator*(double s, Point a) {
    return {s * a.x, s * a.y};
}

Point direction(double radians) {
    return {std::cos(radians), std::sin(radians)};
}

double distance_to(const Wall& wall, Point beam) {
    const Point along = wall.to - wall.from;
    const double denominator = cross(beam, along);
    if (denominator == 0.0) {  // parallel: seen edge on, no width
        return infinity;
    }
    const double distance = cross(wall.from, along) / denominator;
    const double position = cross(wall.from, beam) / denominator;
    return distance > 0.0 && position >= 0.0 && position <= 1.0 ? distance : infinity;
}

double distance_to(const Disc& disc, Point beam) {
    const double closest = dot(disc.centre, beam);
    const double miss = cross(disc.centre, beam);
    const double half_chord_squared = disc.radius * disc.radius - miss * miss;
    if (closest <= 0.0 || half_chord_squared < 0.0) {
        return infinity;
    }
    return closest - std::sqrt(half_chord_squared);
}

double turn_phase(Seconds t, double period_s) {
    return 2.0 * std::numbers::pi * std::fmod(t.count() / period_s, 1.0);
}

// A person walks round the table in 12 s: two legs, the one forward while the other is back.
std::array<Disc, 2> person(Seconds t) {
    constexpr Point table{1300, 1100};
    constexpr double path_radius = 900;
    constexpr double half_hips = 110;
    constexpr double half_stride = 180;
    const double phase = turn_phase(t, 12.0);
    const double stride = half_stride * std::sin(turn_phase(t, 1.5));
    const Point outwards = direction(phase);
    const Point forward = direction(phase + std::numbers::pi / 2.0);
    const Point middle = table + path_radius * outwards;
    return {
        Disc{middle + half_hips * outwards + stride * forward, 65},
        Disc{middle - half_hips * outwards - stride * forward, 65},
    };
}

// A cleaning robot circles behind the scanner the other way, in 20 s.
Disc robot(Seconds t) {
    return {Point{-1000, 600} + 500.0 * direction(-turn_phase(t, 20.0)), 170};
}

}  // namespace

std::optional<double> living_room_distance_mm(double angle_deg, Seconds t) {
    const Point beam = direction(angle_deg * (std::numbers::pi / 180.0));
    double nearest = distance_to(robot(t), beam);
    for (const auto& disc : person(t)) {
        nearest = std::min(nearest, distance_to(disc, beam));
    }
    for (const auto& disc : still_discs) {
        nearest = std::min(nearest, distance_to(disc, beam));
    }
    for (const auto& wall : walls) {
        nearest = std::min(nearest, distance_to(wall, beam));
    }
    return nearest < infinity ? std::optional(nearest) : std::nullopt;
}

}  // namespace sweepcast::virtual_lidar
