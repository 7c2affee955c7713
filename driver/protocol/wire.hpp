// Bytes <-> little-endian integers, and the protocol's XOR checksum. Bytes are parsed, never cast
// to a struct.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace sweepcast::protocol {

/// The unsigned 16-bit integer in the first two bytes.
[[nodiscard]] constexpr std::uint16_t load_le16(std::span<const std::uint8_t, 2> bytes) {
    return static_cast<std::uint16_t>(bytes[0] | (bytes[1] << 8));
}

/// The unsigned 32-bit integer in the first four bytes.
[[nodiscard]] constexpr std::uint32_t load_le32(std::span<const std::uint8_t, 4> bytes) {
    return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8 |
           static_cast<std::uint32_t>(bytes[2]) << 16 | static_cast<std::uint32_t>(bytes[3]) << 24;
}

/// Writes `value` to two bytes, low byte first.
constexpr void store_le16(std::span<std::uint8_t, 2> bytes, std::uint16_t value) {
    bytes[0] = static_cast<std::uint8_t>(value & 0xFFU);
    bytes[1] = static_cast<std::uint8_t>(value >> 8);
}

/// Writes `value` to four bytes, low byte first.
constexpr void store_le32(std::span<std::uint8_t, 4> bytes, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) {
        bytes[i] = static_cast<std::uint8_t>((value >> (8 * i)) & 0xFFU);
    }
}

/// XOR of all bytes; 0 for none. Source: protocol.md 1.2, 7.2.
[[nodiscard]] constexpr std::uint8_t xor_checksum(std::span<const std::uint8_t> bytes) {
    std::uint8_t sum = 0;
    for (const auto byte : bytes) {
        sum = static_cast<std::uint8_t>(sum ^ byte);
    }
    return sum;
}

}  // namespace sweepcast::protocol
