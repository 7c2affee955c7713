// Bytes of answer type 0x82 (express) -> samples.
#pragma once

#include "driver/protocol/decoded.hpp"

#include <cstdint>
#include <span>

namespace sweepcast::protocol {

/// Decodes express capsules: 84 bytes, 32 samples (protocol.md 7.3).
class ExpressDecoder {
public:
    explicit ExpressDecoder(const DecodeSettings& settings);

    /// Appends to `out` what `bytes` complete.
    void push(std::span<const std::uint8_t> bytes, const Arrival& arrival, Decoded& out);
};

}  // namespace sweepcast::protocol
