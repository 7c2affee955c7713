// HQ packets -> samples, with recovery from damage.
#include "driver/protocol/decode_hq.hpp"

#include "driver/protocol/crc32.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>

namespace sweepcast::protocol {
namespace {

bool intact_packet(std::span<const std::uint8_t, hq_packet_size> packet) {
    return packet[0] == hq_sync_byte && crc32_padded(packet.first<hq_checksum_at>()) ==
                                            load_le32(packet.subspan<hq_checksum_at, 4>());
}

/// The first place but 0 where a packet may begin; the end if there is none.
std::size_t next_sync(std::span<const std::uint8_t, hq_packet_size> bytes) {
    const auto found = std::find(bytes.begin() + 1, bytes.end(), hq_sync_byte);
    return static_cast<std::size_t>(found - bytes.begin());
}

}  // namespace

HqDecoder::HqDecoder(const DecodeSettings& settings) : timing_(AnswerType::hq, settings) {}

void HqDecoder::push(std::span<const std::uint8_t> bytes, const Arrival& arrival, Decoded& out) {
    backlog_.feed(bytes, arrival, [&](const TimedBytes& input) { return step(input, out); });
}

/// Deals with the packet or the noise at the front of `input`.
std::size_t HqDecoder::step(const TimedBytes& input, Decoded& out) {
    const auto bytes = input.bytes();
    if (bytes.size() < hq_packet_size) {
        return 0;
    }
    const auto packet = bytes.first<hq_packet_size>();
    if (!intact_packet(packet)) {
        if (!damage_) {
            damage_.emplace(hq_packet_size, packet[0] == hq_sync_byte, out);
        }
        const auto count = next_sync(packet);
        damage_->give_up(count, out);
        return count;
    }
    if (damage_) {
        damage_->report_skipped(out);
        damage_.reset();
    }
    decode(packet, input.arrival_of(hq_packet_size - 1), out);
    return hq_packet_size;
}

void HqDecoder::decode(
    std::span<const std::uint8_t, hq_packet_size> packet,
    SampleTime arrival,
    Decoded& out
) const {
    constexpr std::uint32_t sign_bit = 0x80000000U;
    const auto first = out.samples.size();
    out.samples.resize(first + hq_samples_per_packet);
    auto* sample = out.samples.data() + first;
    auto time = timing_.first_sample(arrival, hq_samples_per_packet);
    for (std::size_t i = 0; i < hq_samples_per_packet; ++i, ++sample) {
        const auto bytes =
            packet.subspan(hq_samples_at + i * hq_sample_size).first<hq_sample_size>();
        const auto distance = load_le32(bytes.subspan<2, 4>());
        sample->time = to_sample_time(time);
        sample->distance.raw = (distance & sign_bit) == 0 ? distance : 0;
        sample->angle.raw = load_le16(bytes.first<2>());
        sample->quality = bytes[6];
        sample->flag = bytes[7];
        time += timing_.sample_duration();
    }
}

}  // namespace sweepcast::protocol
