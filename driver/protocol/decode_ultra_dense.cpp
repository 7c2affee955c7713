// Ultra-dense capsules -> samples.
#include "driver/protocol/decode_ultra_dense.hpp"

#include "driver/protocol/wire.hpp"

#include <cstdlib>

namespace sweepcast::protocol {

template class CapsuleDecoder<UltraDenseFormat>;

namespace {

constexpr std::int32_t smoothed_within_q2 = 8;

/// The distance in quarter millimetres that 20 bits say, averaged with the `last` one if it should
/// be.
std::int32_t distance_q2(std::uint32_t word, std::int32_t last) {
    const auto number = word & 3U;
    const auto& scale = ultra_dense_scales[number];
    const auto steps = static_cast<std::int32_t>(word >> 2 & ((1U << scale.distance_bits) - 1U));
    const auto distance = (scale.first_mm + steps * scale.step_mm) * 4;
    if (number == 0 && last != 0 && std::abs(distance - last) <= smoothed_within_q2) {
        return (distance + last) / 2;
    }
    return distance;
}

/// The bits above the distance, which are the highest of the quality.
std::uint8_t quality_of(std::uint32_t word) {
    const auto bits = ultra_dense_scales[word & 3U].distance_bits;
    return static_cast<std::uint8_t>(word >> (bits + 2) << (bits - 10));
}

}  // namespace

void UltraDenseFormat::decode(const FinishedCapsule<packet_size(type)>& capsule, Sample* sample) {
    CapsuleAngles angles{capsule.start, capsule.turned_q8 * 256 / 64};
    auto time = capsule.first_sample;
    auto mark = mark_;
    auto last = last_distance_q2_;
    const auto put = [&](std::uint32_t word) {
        last = distance_q2(word, last);
        sample->time = time;
        sample->distance.raw = static_cast<std::uint32_t>(last);
        sample->angle = angle_from_q6(angles.raw_q16() >> 10);
        sample->quality = quality_of(word);
        angles.advance();
        sample->flag = capsule_flag(mark.take(angles));
        time += capsule.sample_duration;
        ++sample;
    };
    for (auto at = ultra_dense_cabins_at; at < capsule.bytes.size(); at += ultra_dense_cabin_size) {
        const auto cabin = capsule.bytes.subspan(at).first<ultra_dense_cabin_size>();
        const std::uint32_t high = cabin[4];
        put(load_le16(cabin.first<2>()) | (high & 0x0FU) << 16);
        put(load_le16(cabin.subspan<2, 2>()) | high >> 4 << 16);
    }
    mark_ = mark;
    last_distance_q2_ = last;
}

}  // namespace sweepcast::protocol
