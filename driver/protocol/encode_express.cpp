// Samples -> capsules of answer type 0x82.
#include "driver/protocol/encode_express.hpp"

#include "driver/protocol/capsule.hpp"
#include "driver/protocol/wire.hpp"

#include <span>

namespace sweepcast::protocol {
namespace {

/// The distance word of a sample: whole millimetres above the two high bits of its angle offset.
std::uint16_t distance_word(const ExpressSample& sample) {
    return static_cast<std::uint16_t>(
        (sample.distance_mm & 0x3FFFU) << 2 | (sample.angle_offset_q3 >> 4 & 0x03U)
    );
}

}  // namespace

std::array<std::uint8_t, packet_size(AnswerType::express)> encode_express(
    const ExpressCapsule& capsule
) {
    std::array<std::uint8_t, packet_size(AnswerType::express)> packet{};
    const std::span bytes{packet};
    store_start_word(bytes.subspan<2, 2>(), capsule.restart, capsule.start_angle);
    for (std::size_t i = 0; i < capsule.samples.size(); i += 2) {
        const auto& first = capsule.samples[i];
        const auto& second = capsule.samples[i + 1];
        const auto cabin = bytes.subspan(4 + i / 2 * 5, 5);
        store_le16(cabin.subspan<0, 2>(), distance_word(first));
        store_le16(cabin.subspan<2, 2>(), distance_word(second));
        cabin[4] = static_cast<std::uint8_t>(
            (first.angle_offset_q3 & 0x0FU) | (second.angle_offset_q3 & 0x0FU) << 4
        );
    }
    seal_capsule(bytes);
    return packet;
}

}  // namespace sweepcast::protocol
