// The layout of an HQ packet (0x83), 781 bytes. Source: protocol.md 7.4.
#pragma once

#include "driver/protocol/answer_type.hpp"

#include <cstddef>
#include <cstdint>

namespace sweepcast::protocol {

inline constexpr std::size_t hq_packet_size = packet_size(AnswerType::hq);
inline constexpr std::size_t hq_samples_per_packet = 96;

inline constexpr std::uint8_t hq_sync_byte = 0xA5;  ///< the first byte, the only mark there is
inline constexpr std::size_t hq_time_stamp_at = 1;  ///< eight bytes
inline constexpr std::size_t hq_samples_at = 9;
inline constexpr std::size_t hq_sample_size = 8;
inline constexpr std::size_t hq_checksum_at = 777;  ///< crc32_padded() of all before it
static_assert(hq_samples_at + hq_samples_per_packet * hq_sample_size == hq_checksum_at);

}  // namespace sweepcast::protocol
