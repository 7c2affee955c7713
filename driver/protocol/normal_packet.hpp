// The five bytes of a normal scan (0x81): what marks them as a packet, and what they hold.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/units.hpp"

#include <cstddef>
#include <cstdint>

namespace sweepcast::protocol {

inline constexpr std::size_t normal_packet_size = packet_size(AnswerType::normal);

/// Whether five bytes can be a packet: the start bit differs from its inverse and the check bit is
/// set. One in four pieces of noise passes. Source: protocol.md 7.1.
[[nodiscard]] constexpr bool is_normal_packet(const std::uint8_t* packet) {
    return ((packet[0] ^ packet[0] >> 1) & packet[1] & 1) != 0;
}

[[nodiscard]] constexpr bool normal_starts_revolution(const std::uint8_t* packet) {
    return (packet[0] & 1) != 0;
}

/// The angle; 360 degrees and more wrap. Source: protocol.md 7.1.
[[nodiscard]] constexpr AngleQ14 normal_angle(const std::uint8_t* packet) {
    const unsigned q6 = static_cast<unsigned>(packet[1] | packet[2] << 8) >> 1;
    return {static_cast<std::uint16_t>(q6 * 256U / 90U)};
}

/// Whether a scanner can have turned from one angle to the other between neighbouring samples:
/// forward by less than 1/32 turn, or back by a little jitter.
[[nodiscard]] constexpr bool angle_continues(AngleQ14 from, AngleQ14 to) {
    const auto step = static_cast<std::int16_t>(static_cast<std::uint16_t>(to.raw - from.raw));
    return step >= -65536 / 256 && step < 65536 / 32;
}

}  // namespace sweepcast::protocol
