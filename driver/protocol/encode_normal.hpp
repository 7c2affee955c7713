// Samples -> packets of answer type 0x81 (normal), for the virtual lidar.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/units.hpp"

#include <array>
#include <cstdint>

namespace sweepcast::protocol {

/// What one packet of a normal scan holds, in its own units.
struct NormalMeasurement {
    bool starts_revolution{};
    std::uint8_t quality6{};      ///< strength of the echo, 0..63
    AngleQ6 angle{};              ///< 15 bits
    std::uint16_t distance_q2{};  ///< quarter millimetres; 0: no echo
};

/// The five bytes of a measurement. Values are cut to the bits of their fields. Source:
/// protocol.md 7.1.
[[nodiscard]] std::array<std::uint8_t, packet_size(AnswerType::normal)> encode_normal(
    const NormalMeasurement& measurement
);

}  // namespace sweepcast::protocol
