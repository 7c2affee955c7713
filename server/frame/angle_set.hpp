// AngleSet: which angles of the circle a subscriber wants.
#pragma once

#include "driver/protocol/units.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::frame {

/// Angles from `from_deg` clockwise up to `to_deg`, which is not in it; degrees, [0, 360]. May go
/// over 0. Equal ends are an empty window, but 0 to 360 is the whole circle.
struct AngleWindow {
    double from_deg{};
    double to_deg{};
};

/// A set of angles. Equal sets are equal values, whatever windows they came from.
class AngleSet {
public:
    /// The whole circle.
    AngleSet() = default;

    /// Every angle that is in some window of `keep` (or any, if there is none) and in no window of
    /// `mask`.
    AngleSet(std::span<const AngleWindow> keep, std::span<const AngleWindow> mask);

    [[nodiscard]] bool contains(protocol::AngleQ14 angle) const;
    [[nodiscard]] bool is_whole_circle() const {
        return ranges_.size() == 1 && is_turn(ranges_[0]);
    }
    [[nodiscard]] bool is_empty() const { return ranges_.empty(); }

    /// Windows that make this set.
    [[nodiscard]] std::vector<AngleWindow> windows() const;

    bool operator==(const AngleSet&) const = default;

private:
    /// In 1/65536 turn; `end` is not in it.
    struct Range {
        std::uint32_t begin{};
        std::uint32_t end{};
        bool operator==(const Range&) const = default;
    };
    static constexpr Range turn{0, 65536};
    static constexpr bool is_turn(const Range& range) { return range == turn; }

    std::vector<Range> ranges_{turn};  ///< ascending, apart from each other
};

}  // namespace sweepcast::frame
