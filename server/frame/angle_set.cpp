#include "server/frame/angle_set.hpp"

#include <algorithm>
#include <cmath>

namespace sweepcast::frame {

namespace {

constexpr std::uint32_t units_per_turn = 65536;

/// The first angle that is not below `degrees`.
std::uint32_t at_or_above(double degrees) {
    return static_cast<std::uint32_t>(std::ceil(degrees * units_per_turn / 360.0));
}

double to_degrees(std::uint32_t units) {
    return units * (360.0 / units_per_turn);
}

/// A window in units of angle, which wrap around.
struct Arc {
    explicit Arc(const AngleWindow& window) : begin(at_or_above(window.from_deg)) {
        const auto end = at_or_above(window.to_deg);
        length = end - begin;
        if (window.to_deg < window.from_deg) {
            length += units_per_turn;
        }
        begin %= units_per_turn;
    }
    [[nodiscard]] bool contains(std::uint32_t angle) const {
        return (angle - begin) % units_per_turn < length;
    }
    std::uint32_t begin;
    std::uint32_t length{};
};

bool any_contains(const std::vector<Arc>& arcs, std::uint32_t angle) {
    return std::any_of(arcs.begin(), arcs.end(), [angle](const Arc& arc) {
        return arc.contains(angle);
    });
}

}  // namespace

AngleSet::AngleSet(std::span<const AngleWindow> keep, std::span<const AngleWindow> mask) {
    const std::vector<Arc> kept(keep.begin(), keep.end());
    const std::vector<Arc> masked(mask.begin(), mask.end());
    // Between two neighbouring ends of windows all angles fare alike.
    std::vector<std::uint32_t> ends{0, units_per_turn};
    for (const auto* arcs : {&kept, &masked}) {
        for (const auto& arc : *arcs) {
            ends.push_back(arc.begin);
            ends.push_back((arc.begin + arc.length) % units_per_turn);
        }
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());

    ranges_.clear();
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        const Range range{ends[i], ends[i + 1]};
        const bool is_in =
            (kept.empty() || any_contains(kept, range.begin)) && !any_contains(masked, range.begin);
        if (is_in && !ranges_.empty() && ranges_.back().end == range.begin) {
            ranges_.back().end = range.end;
        } else if (is_in) {
            ranges_.push_back(range);
        }
    }
}

bool AngleSet::contains(protocol::AngleQ14 angle) const {
    const auto after = std::upper_bound(
        ranges_.begin(),
        ranges_.end(),
        std::uint32_t{angle.raw},
        [](std::uint32_t value, const Range& range) { return value < range.begin; }
    );
    return after != ranges_.begin() && angle.raw < std::prev(after)->end;
}

std::vector<AngleWindow> AngleSet::windows() const {
    std::vector<AngleWindow> windows;
    for (const auto& range : ranges_) {
        windows.push_back({to_degrees(range.begin), to_degrees(range.end)});
    }
    return windows;
}

}  // namespace sweepcast::frame
