// CRC-32, as HQ packets (0x83) carry it.
#pragma once

#include <cstdint>
#include <span>

namespace sweepcast::protocol {

/// The CRC-32 of `bytes` followed by as many zero bytes as make its length a multiple of four (four
/// if it is one already): polynomial 04C11DB7 reflected, initial value and final XOR FFFFFFFF.
/// Source: protocol.md 7.4.
[[nodiscard]] std::uint32_t crc32_padded(std::span<const std::uint8_t> bytes);

}  // namespace sweepcast::protocol
