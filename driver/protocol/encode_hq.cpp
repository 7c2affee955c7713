// Samples -> packets of answer type 0x83.
#include "driver/protocol/encode_hq.hpp"

#include "driver/protocol/crc32.hpp"
#include "driver/protocol/wire.hpp"

#include <span>

namespace sweepcast::protocol {

std::array<std::uint8_t, packet_size(AnswerType::hq)> encode_hq(const HqPacket& packet) {
    std::array<std::uint8_t, packet_size(AnswerType::hq)> encoded{};
    const std::span bytes{encoded};
    bytes[0] = hq_sync_byte;
    const auto time_stamp = bytes.subspan<hq_time_stamp_at, 8>();
    store_le32(time_stamp.first<4>(), static_cast<std::uint32_t>(packet.time_stamp & 0xFFFFFFFFU));
    store_le32(time_stamp.last<4>(), static_cast<std::uint32_t>(packet.time_stamp >> 32));
    auto rest = bytes.subspan(hq_samples_at);
    for (const auto& sample : packet.samples) {
        store_le16(rest.first<2>(), sample.angle.raw);
        store_le32(rest.subspan<2, 4>(), sample.distance.raw);
        rest[6] = sample.quality;
        rest[7] = sample.flag;
        rest = rest.subspan(hq_sample_size);
    }
    store_le32(bytes.subspan<hq_checksum_at, 4>(), crc32_padded(bytes.first<hq_checksum_at>()));
    return encoded;
}

}  // namespace sweepcast::protocol
