// The units of the distance column: millimetres where that loses nothing, else quarters of one; or
// what a subscriber wants.
#pragma once

#include "driver/protocol/units.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace sweepcast::frame {

constexpr std::uint32_t um_per_mm = 1000;
constexpr std::uint32_t um_per_q2 = 250;
/// The coarsest that may be wanted: a metre.
constexpr std::uint32_t coarsest_um = 1'000'000;

/// The distance of an echo in units of `unit_um` micrometres (not 0): the nearest there is, but
/// never 0, which would be no echo.
constexpr std::uint64_t to_units(protocol::DistanceQ2 distance, std::uint32_t unit_um) {
    const std::uint64_t um = std::uint64_t{distance.raw} * um_per_q2;
    return std::max<std::uint64_t>((um + unit_um / 2) / unit_um, 1);
}

/// The farthest distance in units of `unit_um` (1 to coarsest_um) that from_units() takes.
constexpr std::uint64_t farthest_in(std::uint32_t unit_um) {
    return std::uint64_t{std::numeric_limits<std::uint32_t>::max()} * um_per_q2 / unit_um + 1;
}

/// The inverse of to_units(), of at most farthest_in().
constexpr protocol::DistanceQ2 distance_from_units(std::uint64_t units, std::uint32_t unit_um) {
    const std::uint64_t q2 = (units * unit_um + um_per_q2 / 2) / um_per_q2;
    return {static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(q2, 1, std::numeric_limits<std::uint32_t>::max())
    )};
}

}  // namespace sweepcast::frame
