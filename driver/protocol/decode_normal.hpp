// Bytes of answer type 0x81 (normal) -> samples.
#pragma once

#include "driver/protocol/decoded.hpp"

#include <cstdint>
#include <span>

namespace sweepcast::protocol {

/// Decodes a normal scan: five bytes, one sample (protocol.md 7.1).
class NormalDecoder {
public:
    explicit NormalDecoder(const DecodeSettings& settings);

    /// Appends to `out` what `bytes` complete.
    void push(std::span<const std::uint8_t> bytes, const Arrival& arrival, Decoded& out);
};

}  // namespace sweepcast::protocol
