// Samples -> capsules of answer type 0x86.
#include "driver/protocol/encode_ultra_dense.hpp"

#include "driver/protocol/capsule.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>
#include <span>

namespace sweepcast::protocol {
namespace {

/// The 20 bits of a sample.
std::uint32_t encode_sample(const UltraDenseSample& sample) {
    const std::int32_t mm =
        std::min<std::int32_t>(sample.distance_mm, ultra_dense_scales[3].last_mm());
    std::uint32_t number = 0;
    while (mm > ultra_dense_scales[number].last_mm()) {
        ++number;
    }
    const auto& scale = ultra_dense_scales[number];
    auto steps = (mm - scale.first_mm + scale.step_mm / 2) / scale.step_mm;
    if (number == 0 && mm > 0) {
        steps = std::clamp(steps, 1, 1023);  // 0 would say that there is no echo
    }
    const std::uint32_t quality = sample.quality >> (scale.distance_bits - 10);
    return quality << (scale.distance_bits + 2) | static_cast<std::uint32_t>(steps) << 2 | number;
}

}  // namespace

std::array<std::uint8_t, packet_size(AnswerType::ultra_dense)> encode_ultra_dense(
    const UltraDenseCapsule& capsule
) {
    std::array<std::uint8_t, packet_size(AnswerType::ultra_dense)> packet{};
    const std::span bytes{packet};
    store_le32(bytes.subspan<ultra_dense_time_stamp_at, 4>(), capsule.time_stamp);
    store_le16(bytes.subspan<ultra_dense_status_at, 2>(), capsule.status);
    store_start_word(
        bytes.subspan<ultra_dense_start_at, 2>(),
        capsule.restart,
        capsule.start_angle
    );
    auto cabin = bytes.subspan(ultra_dense_cabins_at);
    for (std::size_t i = 0; i < capsule.samples.size(); i += 2) {
        const auto first = encode_sample(capsule.samples[i]);
        const auto second = encode_sample(capsule.samples[i + 1]);
        store_le16(cabin.first<2>(), static_cast<std::uint16_t>(first & 0xFFFFU));
        store_le16(cabin.subspan<2, 2>(), static_cast<std::uint16_t>(second & 0xFFFFU));
        cabin[4] = static_cast<std::uint8_t>(first >> 16 | second >> 16 << 4);
        cabin = cabin.subspan(ultra_dense_cabin_size);
    }
    seal_capsule(bytes);
    return packet;
}

}  // namespace sweepcast::protocol
