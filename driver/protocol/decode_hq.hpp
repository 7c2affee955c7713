// Bytes of answer type 0x83 (HQ) -> samples.
#pragma once

#include "driver/protocol/backlog.hpp"
#include "driver/protocol/decoded.hpp"
#include "driver/protocol/hq_packet.hpp"
#include "driver/protocol/line_damage.hpp"
#include "driver/protocol/sample_timing.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace sweepcast::protocol {

/// Decodes HQ packets: 781 bytes, 96 samples that say everything themselves. Source:
/// protocol.md 7.4, 8.
///
/// An undamaged stream gives bit for bit what the vendor's decoder gives, but for times: each
/// sample has its own. After damage this one recovers more, since it searches the bytes of a bad
/// packet for the beginning of another one; 32 bits of checksum leave no doubt about what it finds.
/// A distance of 2^31 or more, which is nonsense, comes out as 0, no echo.
class HqDecoder {
public:
    explicit HqDecoder(const DecodeSettings& settings);

    /// Appends to `out` what `bytes` complete.
    void push(std::span<const std::uint8_t> bytes, const Arrival& arrival, Decoded& out);

private:
    std::size_t step(const TimedBytes& input, Decoded& out);
    void decode(
        std::span<const std::uint8_t, hq_packet_size> packet,
        SampleTime arrival,
        Decoded& out
    ) const;

    SampleTiming timing_;
    Backlog<hq_packet_size> backlog_;
    std::optional<LineDamage> damage_;
};

}  // namespace sweepcast::protocol
