// What all capsules (0x82, 0x84, 0x85, 0x86) share: the two sync nibbles, the checksum in between,
// angles that interpolate.
#pragma once

#include "driver/protocol/units.hpp"
#include "driver/protocol/wire.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace sweepcast::protocol {

/// Whether a capsule can begin with these two bytes. Source: protocol.md 7.2.
[[nodiscard]] constexpr bool opens_capsule(std::uint8_t first, std::uint8_t second) {
    return (first >> 4) == 0xA && (second >> 4) == 0x5;
}

/// Whether `capsule`, a whole one, has its sync nibbles and the right checksum. Source:
/// protocol.md 7.2.
[[nodiscard]] constexpr bool intact_capsule(std::span<const std::uint8_t> capsule) {
    return opens_capsule(capsule[0], capsule[1]) &&
           xor_checksum(capsule.subspan(2)) == ((capsule[0] & 0x0F) | (capsule[1] & 0x0F) << 4);
}

/// Writes sync nibbles and checksum into the first two bytes of a capsule that is complete
/// otherwise.
constexpr void seal_capsule(std::span<std::uint8_t> capsule) {
    const auto checksum = xor_checksum(capsule.subspan(2));
    capsule[0] = static_cast<std::uint8_t>(0xA0 | (checksum & 0x0F));
    capsule[1] = static_cast<std::uint8_t>(0x50 | checksum >> 4);
}

/// The word that holds a capsule's start angle and restart bit.
struct StartWord {
    std::uint16_t raw{};
    [[nodiscard]] constexpr bool restart() const { return (raw & 0x8000U) != 0; }
    [[nodiscard]] constexpr AngleQ6 angle() const {
        return {static_cast<std::uint16_t>(raw & 0x7FFFU)};
    }
};

/// Writes the start word.
constexpr void store_start_word(std::span<std::uint8_t, 2> word, bool restart, AngleQ6 start) {
    store_le16(word, static_cast<std::uint16_t>((start.raw & 0x7FFFU) | (restart ? 0x8000U : 0U)));
}

/// One turn in the fixed-point units of capsule arithmetic.
inline constexpr std::int32_t turn_q6 = 360 << 6;
inline constexpr std::int32_t turn_q8 = 360 << 8;
inline constexpr std::int32_t turn_q16 = 360 << 16;

/// A limit for such a turn that none exceeds.
inline constexpr std::int32_t any_turn = std::numeric_limits<std::int32_t>::max();

/// How far the scanner turned from one start angle to the next, in 1/256 degree; negative only if
/// `from` is beyond a whole turn. Source: protocol.md 7.2.
[[nodiscard]] constexpr std::int32_t turned_q8(AngleQ6 from, AngleQ6 to) {
    return (to.raw - from.raw) * 4 + (from.raw > to.raw ? turn_q8 : 0);
}

/// The angle that a q6 value stands for, corrected by at most one turn as the vendor does.
/// Source: protocol.md 7.0.
[[nodiscard]] constexpr AngleQ14 angle_from_q6(std::int32_t q6) {
    q6 += q6 < 0 ? turn_q6 : 0;
    q6 -= q6 >= turn_q6 ? turn_q6 : 0;
    // Signed division, as a doubly negative angle stays negative; 256/90 in lowest terms.
    return {static_cast<std::uint16_t>(q6 * 128 / 45)};
}

}  // namespace sweepcast::protocol
