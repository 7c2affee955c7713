// Wish: what a subscriber wants of a lidar's scans, in normal form: wishes that get the same frames
// are mostly equal, and equal ones share every frame.
#pragma once

#include "driver/protocol/units.hpp"
#include "server/frame/angle_set.hpp"
#include "server/frame/frame_content.hpp"

#include <chrono>
#include <cstdint>
#include <limits>

namespace sweepcast::frame {

/// Which sample of a bin is taken.
enum class BinPick : std::uint8_t {
    nearest_angle,  ///< the one measured nearest to the bin's middle
    minimum,        ///< the one with the nearest echo
};

/// How much of a revolution a sector spans if its subscriber does not say, in 1/1000 degree.
constexpr std::uint32_t usual_sector_mdeg = 30'000;

/// The circle cut into equal parts, the first beginning at angle 0.
struct Bins {
    std::uint32_t count{};  ///< 0: samples as measured
    BinPick pick{BinPick::nearest_angle};
    bool operator==(const Bins&) const = default;
};

/// Whoever makes one has checked it: the stream refuses what contradicts itself.
struct Wish {
    Kind kind{Kind::sweep};
    FrameFormat format;

    /// Sectors: how much of a turn each spans, in 1/1000 degree; 0: as much as comes within
    /// `max_latency`.
    std::uint32_t sector_mdeg{};
    /// Sectors: how long a sample may wait for its sector to be sent; 0: for all of `sector_mdeg`.
    std::chrono::microseconds max_latency{};
    /// Sweeps: the time from one to the next, on average at least; 0: every one.
    std::chrono::microseconds least_interval{};

    /// Samples at other angles are left out.
    AngleSet angles;
    /// Echoes outside of these, or weaker, count as none.
    protocol::DistanceQ2 nearest{0};
    protocol::DistanceQ2 farthest{std::numeric_limits<std::uint32_t>::max()};
    std::uint8_t min_quality{};
    /// Only every so-manieth sample, counted from the sweep's first.
    std::uint32_t every_nth{1};
    /// Sweeps.
    Bins bins;

    bool operator==(const Wish&) const = default;
};

}  // namespace sweepcast::frame
