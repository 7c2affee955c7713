// Measurement bytes -> samples, whatever the answer type. The state machine of each type has a file
// of its own.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/decode_dense.hpp"
#include "driver/protocol/decode_express.hpp"
#include "driver/protocol/decode_hq.hpp"
#include "driver/protocol/decode_normal.hpp"
#include "driver/protocol/decode_ultra.hpp"
#include "driver/protocol/decode_ultra_dense.hpp"
#include "driver/protocol/decoded.hpp"
#include "driver/protocol/result.hpp"

#include <cstdint>
#include <span>
#include <variant>

namespace sweepcast::protocol {

/// Decodes one measurement stream. Feed it the bytes that follow the response descriptor, cut
/// anywhere.
class Decoder {
public:
    /// A decoder for the stream that a descriptor announced.
    /// Errors: errc::unsupported_answer_type.
    static Result<Decoder> create(AnswerType type, const DecodeSettings& settings);

    /// Appends what `bytes` complete to `out` (which the caller empties and reuses: nothing is
    /// allocated per packet once its vectors have grown).
    void push(std::span<const std::uint8_t> bytes, const Arrival& arrival, Decoded& out);

private:
    using State = std::variant<
        NormalDecoder,
        ExpressDecoder,
        HqDecoder,
        UltraDecoder,
        DenseDecoder,
        UltraDenseDecoder>;
    explicit Decoder(State state) : state_(std::move(state)) {}
    State state_;
};

}  // namespace sweepcast::protocol
