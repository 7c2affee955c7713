// Samples -> capsules of answer type 0x85.
#include "driver/protocol/encode_dense.hpp"

#include "driver/protocol/capsule.hpp"
#include "driver/protocol/wire.hpp"

#include <span>

namespace sweepcast::protocol {

std::array<std::uint8_t, packet_size(AnswerType::dense)> encode_dense(const DenseCapsule& capsule) {
    std::array<std::uint8_t, packet_size(AnswerType::dense)> packet{};
    const std::span bytes{packet};
    store_start_word(bytes.subspan<2, 2>(), capsule.restart, capsule.start_angle);
    auto rest = bytes.subspan(4);
    for (const auto distance_mm : capsule.distances_mm) {
        store_le16(rest.first<2>(), distance_mm);
        rest = rest.subspan(2);
    }
    seal_capsule(bytes);
    return packet;
}

}  // namespace sweepcast::protocol
