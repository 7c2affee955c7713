// Ways to feed a decoder: whole, byte by byte, cut anywhere.
#pragma once

#include "driver/protocol/decode.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace sweepcast::protocol {

using Bytes = std::vector<std::uint8_t>;

/// A decoder for a type that is known to be supported.
inline Decoder make_decoder(AnswerType type, const DecodeSettings& settings = {}) {
    return Decoder::create(type, settings).value();
}

/// Decodes `bytes` handed over in pieces whose sizes `next_size()` says, all at time 0.
template <class NextSize>
Decoded decode_in_pieces(
    AnswerType type,
    const DecodeSettings& settings,
    std::span<const std::uint8_t> bytes,
    NextSize next_size
) {
    auto decoder = make_decoder(type, settings);
    Decoded decoded;
    while (!bytes.empty()) {
        const auto piece = bytes.first(std::min<std::size_t>(next_size(), bytes.size()));
        decoder.push(piece, {}, decoded);
        bytes = bytes.subspan(piece.size());
    }
    return decoded;
}

inline Decoded decode_whole(
    AnswerType type,
    std::span<const std::uint8_t> bytes,
    const DecodeSettings& settings = {}
) {
    return decode_in_pieces(type, settings, bytes, [&] { return bytes.size(); });
}

/// The samples with their times taken off, to compare with vectors that have none.
inline std::vector<Sample> without_times(std::vector<Sample> samples) {
    for (auto& sample : samples) {
        sample.time = {};
    }
    return samples;
}

/// The vendor's samples as ours should be: a distance of 2^31 or more, a negative one wrapped, is
/// no echo.
inline std::vector<Sample> without_nonsense(std::vector<Sample> samples) {
    for (auto& sample : samples) {
        if ((sample.distance.raw & 0x80000000U) != 0) {
            sample.distance = {};
        }
    }
    return samples;
}

}  // namespace sweepcast::protocol
