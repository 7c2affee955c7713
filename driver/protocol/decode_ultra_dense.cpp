// Ultra-dense capsules -> samples.
#include "driver/protocol/decode_ultra_dense.hpp"

#include "driver/protocol/wire.hpp"

#include <array>
#include <cstddef>
#include <cstdlib>

namespace sweepcast::protocol {

template class CapsuleDecoder<UltraDenseFormat>;

namespace {

/// A scale as masks over the 20 bits of a sample: no shift depends on the scale.
struct ScaleMasks {
    std::uint32_t distance{};  ///< in its place, two bits up: quarters of steps
    std::int32_t step_mm{};
    std::int32_t first_q2{};
    std::uint32_t quality{};            ///< of the highest 8 bits, those that are quality
    std::int32_t smoothed_within_q2{};  ///< of the distance before
};

constexpr auto scale_masks = [] {
    std::array<ScaleMasks, ultra_dense_scales.size()> masks{};
    for (std::size_t i = 0; i < masks.size(); ++i) {
        const auto& scale = ultra_dense_scales[i];
        masks[i] = {
            .distance = ((1U << scale.distance_bits) - 1U) << 2,
            .step_mm = scale.step_mm,
            .first_q2 = scale.first_mm * 4,
            .quality = 0xFFU << (scale.distance_bits - 10) & 0xFFU,
            .smoothed_within_q2 = i == 0 ? 8 : -1};
    }
    return masks;
}();

}  // namespace

void UltraDenseFormat::decode(const FinishedCapsule<packet_size(type)>& capsule, Sample* sample) {
    CapsuleAngles angles{capsule.start, capsule.turned_q8 * 256 / 64};
    auto time = capsule.first_sample;
    auto mark = mark_;
    auto last = last_distance_q2_;
    const auto put = [&](std::uint32_t word) {
        const auto& scale = scale_masks[word & 3U];
        const auto alone =
            static_cast<std::int32_t>(word & scale.distance) * scale.step_mm + scale.first_q2;
        const bool smoothed = last != 0 && std::abs(alone - last) <= scale.smoothed_within_q2;
        last = smoothed ? (alone + last) / 2 : alone;
        sample->time = to_sample_time(time);
        sample->distance.raw = static_cast<std::uint32_t>(last);
        sample->angle = angle_from_q6(angles.raw_q16() >> 10);
        sample->quality = static_cast<std::uint8_t>(word >> 12 & scale.quality);
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
