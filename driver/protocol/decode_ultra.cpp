// Ultra capsules -> samples.
#include "driver/protocol/decode_ultra.hpp"

#include "driver/protocol/capsule_angles.hpp"
#include "driver/protocol/wire.hpp"

#include <array>

namespace sweepcast::protocol {

template class CapsuleDecoder<UltraFormat>;

namespace {

using Distances = std::array<std::int32_t, ultra_samples_per_capsule>;

/// A distance in quarter millimetres relative to a major; negative if the bytes are nonsense.
std::int32_t relative_q2(std::int32_t difference, const UltraMajor& base) {
    const auto distance = (difference * base.step + base.mm) * 4;
    const bool echo = difference != ultra_no_echo && difference != ultra_no_echo_too;
    return echo ? distance : 0;
}

/// The meaning of a cabin's lowest 12 bits.
UltraMajor major_of(std::uint32_t cabin) {
    return ultra_major(static_cast<std::int32_t>(cabin & 0xFFFU));
}

/// The distances of a capsule in quarter millimetres, negative ones included.
Distances distances_q2(const FinishedCapsule<packet_size(AnswerType::ultra)>& capsule) {
    Distances distances;
    auto* out = distances.data();
    auto cabin = load_le32(capsule.bytes.subspan<4, 4>());
    auto major = major_of(cabin);
    for (std::size_t i = 1; i <= ultra_cabins_per_capsule; ++i) {
        const bool last = i == ultra_cabins_per_capsule;
        const auto next_cabin = load_le32(
            last ? capsule.next.subspan<4, 4>() : capsule.bytes.subspan(4 + 4 * i).first<4>()
        );
        const auto next_major = major_of(next_cabin);
        const auto second = static_cast<std::int32_t>(cabin << 10) >> 22;
        const auto third = static_cast<std::int32_t>(cabin) >> 22;
        *out++ = major.mm * 4;
        *out++ = relative_q2(second, major.mm == 0 && next_major.mm != 0 ? next_major : major);
        *out++ = relative_q2(third, next_major);
        cabin = next_cabin;
        major = next_major;
    }
    if (!capsule.next_follows) {
        // What the last cabin is relative to was lost.
        distances[95] = 0;
        distances[94] = distances[93] != 0 ? distances[94] : 0;
    }
    return distances;
}

}  // namespace

void UltraFormat::decode(const FinishedCapsule<packet_size(type)>& capsule, Sample* sample) {
    const auto distances = distances_q2(capsule);
    std::array<std::int32_t, ultra_samples_per_capsule> nearness{};
    for (std::size_t i = 0; i < nearness.size(); ++i) {  // apart, so that it takes four at a time
        nearness[i] = ultra_nearness(distances[i]);
    }
    CapsuleAngles angles{capsule.start, capsule.turned_q8 * 8 / 3};  // rounded toward zero
    auto time = capsule.first_sample;
    for (std::size_t i = 0; i < distances.size(); ++i, ++sample) {
        const auto distance = distances[i];
        const auto corrected =
            angles.raw_q16() - ultra_offsets_q16[static_cast<std::size_t>(nearness[i])];
        angles.advance();
        sample->time = to_sample_time(time);
        sample->distance.raw = static_cast<std::uint32_t>(distance > 0 ? distance : 0);
        sample->angle = angle_from_q6(corrected >> 10);
        sample->quality = distance != 0 ? quality_with_echo : 0;
        sample->flag = capsule_flag(angles.passed_zero_within(1));
        time += capsule.sample_duration;
    }
}

}  // namespace sweepcast::protocol
