// Samples -> packets of answer type 0x81.
#include "driver/protocol/encode_normal.hpp"

#include "driver/protocol/wire.hpp"

#include <span>

namespace sweepcast::protocol {

std::array<std::uint8_t, packet_size(AnswerType::normal)> encode_normal(
    const NormalMeasurement& measurement
) {
    std::array<std::uint8_t, packet_size(AnswerType::normal)> packet{};
    const unsigned start_bits = measurement.starts_revolution ? 0b01 : 0b10;
    packet[0] = static_cast<std::uint8_t>((measurement.quality6 & 0x3FU) << 2 | start_bits);
    store_le16(
        std::span(packet).subspan<1, 2>(),
        static_cast<std::uint16_t>((measurement.angle.raw & 0x7FFFU) << 1 | 1U)
    );
    store_le16(std::span(packet).subspan<3, 2>(), measurement.distance_q2);
    return packet;
}

}  // namespace sweepcast::protocol
