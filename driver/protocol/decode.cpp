// The decoder for whatever answer type a descriptor announced.
#include "driver/protocol/decode.hpp"

#include "driver/protocol/error.hpp"

namespace sweepcast::protocol {

Result<Decoder> Decoder::create(AnswerType type, const DecodeSettings& settings) {
    switch (type) {
    case AnswerType::normal:
        return Decoder{NormalDecoder{settings}};
    case AnswerType::express:
        return Decoder{ExpressDecoder{settings}};
    case AnswerType::hq:
        return Decoder{HqDecoder{settings}};
    case AnswerType::ultra:
        return Decoder{UltraDecoder{settings}};
    case AnswerType::dense:
        return Decoder{DenseDecoder{settings}};
    case AnswerType::ultra_dense:
        return Decoder{UltraDenseDecoder{settings}};
    }
    return make_error_code(errc::unsupported_answer_type);
}

void Decoder::push(std::span<const std::uint8_t> bytes, const Arrival& arrival, Decoded& out) {
    std::visit([&](auto& decoder) { decoder.push(bytes, arrival, out); }, state_);
}

}  // namespace sweepcast::protocol
