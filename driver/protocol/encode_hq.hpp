// Samples -> packets of answer type 0x83 (HQ), for the virtual lidar.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/hq_packet.hpp"
#include "driver/protocol/units.hpp"

#include <array>
#include <cstdint>

namespace sweepcast::protocol {

/// One sample of an HQ packet: what it says is what a receiver gets, unchanged.
struct HqSample {
    AngleQ14 angle{};
    DistanceQ2 distance{};
    std::uint8_t quality{};
    std::uint8_t flag{};  ///< bit 0: first of a revolution
};

/// What one HQ packet holds.
struct HqPacket {
    std::uint64_t time_stamp{};  ///< the device's clock
    std::array<HqSample, hq_samples_per_packet> samples{};
};

/// The 781 bytes of a packet. Source: protocol.md 7.4.
[[nodiscard]] std::array<std::uint8_t, packet_size(AnswerType::hq)> encode_hq(const HqPacket& packet
);

}  // namespace sweepcast::protocol
