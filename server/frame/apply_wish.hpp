// Samples as measured -> samples as wished for.
#pragma once

#include "driver/protocol/sample.hpp"
#include "server/frame/wish.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace sweepcast::frame {

/// What `wish` makes of samples that are those from number `first` on (counted from 0) of their
/// sweep. In this order:
///  1. every so-manieth sample of the sweep is taken;
///  2. those at angles that are not wanted are left out;
///  3. echoes that are too near, too far or too weak become none: distance and quality 0;
///  4. bins are filled with what is left, if there are any: one sample for each, by angle, at the
///     bin's middle (to be told in units of 1/(2 * count) turn), with distance, quality and time of
///     the sample picked. A bin without any has no echo and the time that its neighbours suggest,
///     or that of the samples left out under 2, if there are some. The flag is 1 for the first bin,
///     else 0: bins begin their revolution at angle 0, wherever the lidar does.
/// The result is `samples` itself if the wish changes none, else it lies in `memory`.
[[nodiscard]] std::span<const protocol::Sample> apply_wish(
    const Wish& wish,
    std::span<const protocol::Sample> samples,
    std::size_t first,
    std::vector<protocol::Sample>& memory
);

}  // namespace sweepcast::frame
