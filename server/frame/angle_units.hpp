// The units of the angle column: 1/23040 turn where that loses nothing, for it makes smaller
// numbers, else 1/65536; or what a subscriber wants.
#pragma once

#include "driver/protocol/units.hpp"

#include <cstdint>

namespace sweepcast::frame {

constexpr std::uint32_t q6_per_turn = 23040;
constexpr std::uint32_t q14_per_turn = 65536;

/// The angle that the vendor's decoders make of `q6` (1/64 degree, below 23040). Source:
/// protocol.md 7.0.
constexpr protocol::AngleQ14 from_q6(std::uint32_t q6) {
    return {static_cast<std::uint16_t>(q6 * 256 / 90)};
}

/// The one angle in 1/64 degree that from_q6 could make `angle` of; whether it does is for is_q6 to
/// say.
constexpr std::uint32_t to_q6(protocol::AngleQ14 angle) {
    return (std::uint32_t{angle.raw} * 90 + 255) / 256;
}

/// Whether from_q6(to_q6(angle)) gives `angle` back: true of all that come from 1/64 degrees.
constexpr bool is_q6(protocol::AngleQ14 angle) {
    const std::uint32_t q6 = to_q6(angle);
    return q6 < q6_per_turn && from_q6(q6) == angle;
}

/// The angle in units of 1/`per_turn` turn: exact in our two units if it is one of theirs, else the
/// nearest there is. `per_turn` is 1 to 65536.
constexpr std::uint32_t to_units(protocol::AngleQ14 angle, std::uint32_t per_turn) {
    if (per_turn == q6_per_turn && is_q6(angle)) {
        return to_q6(angle);
    }
    const std::uint64_t scaled = std::uint64_t{angle.raw} * per_turn + q14_per_turn / 2;
    return static_cast<std::uint32_t>(scaled / q14_per_turn % per_turn);
}

/// The inverse of to_units(); `units` is below `per_turn`.
constexpr protocol::AngleQ14 from_units(std::uint32_t units, std::uint32_t per_turn) {
    if (per_turn == q6_per_turn) {
        return from_q6(units);
    }
    const std::uint64_t scaled = std::uint64_t{units} * q14_per_turn + per_turn / 2;
    return {static_cast<std::uint16_t>(scaled / per_turn % q14_per_turn)};
}

static_assert(from_q6(90 * 64).raw == 16384 && to_q6({16384}) == 90 * 64);
static_assert(is_q6(from_q6(1)) && is_q6(from_q6(q6_per_turn - 1)));
static_assert(!is_q6({1}) && !is_q6({65535}));

}  // namespace sweepcast::frame
