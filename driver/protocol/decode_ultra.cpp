// Ultra capsules -> samples.
#include "driver/protocol/decode_ultra.hpp"

#include "driver/protocol/capsule_angles.hpp"
#include "driver/protocol/wire.hpp"

#include <array>

namespace sweepcast::protocol {

template class CapsuleDecoder<UltraFormat>;

namespace {

/// A distance in quarter millimetres relative to a major; negative if the bytes are nonsense.
std::int32_t relative_q2(std::int32_t difference, const UltraMajor& base) {
    if (difference == ultra_no_echo || difference == ultra_no_echo_too) {
        return 0;
    }
    return (difference * (1 << base.level) + base.mm) * 4;
}

/// The meaning of a cabin's lowest 12 bits.
UltraMajor major_of(std::uint32_t cabin) {
    return ultra_major(static_cast<std::int32_t>(cabin & 0xFFFU));
}

}  // namespace

void UltraFormat::decode(const FinishedCapsule<packet_size(type)>& capsule, Sample* sample) {
    // A third of 1/32: rounded toward zero.
    CapsuleAngles angles{capsule.start, capsule.turned_q8 * 8 / 3};
    auto time = capsule.first_sample;
    const auto put = [&](std::int32_t distance_q2) {
        const auto corrected = angles.raw_q16() - ultra_angle_offset_q16(distance_q2);
        angles.advance();
        sample->time = time;
        sample->distance.raw = static_cast<std::uint32_t>(distance_q2 > 0 ? distance_q2 : 0);
        sample->angle = angle_from_q6(corrected >> 10);
        sample->quality = distance_q2 != 0 ? quality_with_echo : 0;
        sample->flag = capsule_flag(angles.passed_zero_within(1));
        time += capsule.sample_duration;
        ++sample;
    };
    auto cabin = load_le32(capsule.bytes.subspan<4, 4>());
    auto major = major_of(cabin);
    for (std::size_t i = 0; i < ultra_cabins_per_capsule; ++i) {
        const bool last = i + 1 == ultra_cabins_per_capsule;
        const auto next_cabin = load_le32(
            last ? capsule.next.subspan<4, 4>() : capsule.bytes.subspan(8 + 4 * i).first<4>()
        );
        const auto next_major = major_of(next_cabin);
        const bool next_known = !last || capsule.next_follows;
        const auto second = static_cast<std::int32_t>(cabin << 10) >> 22;
        const auto third = static_cast<std::int32_t>(cabin) >> 22;
        const bool from_next = major.mm == 0 && next_major.mm != 0;
        put(major.mm * 4);
        put(next_known || major.mm != 0 ? relative_q2(second, from_next ? next_major : major) : 0);
        put(next_known ? relative_q2(third, next_major) : 0);
        cabin = next_cabin;
        major = next_major;
    }
}

}  // namespace sweepcast::protocol
