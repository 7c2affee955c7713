// Bytes of answer type 0x82 (express) -> samples.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/capsule_decoder.hpp"
#include "driver/protocol/encode_express.hpp"

namespace sweepcast::protocol {

/// What the bytes of an express capsule mean: 16 cabins of two samples, each with an angle offset
/// of its own. Source: protocol.md 7.3.
class ExpressFormat {
public:
    static constexpr AnswerType type = AnswerType::express;
    static constexpr std::size_t samples_per_capsule = express_samples_per_capsule;
    static constexpr std::size_t start_word_at = 2;

    [[nodiscard]] static constexpr std::int32_t greatest_turn_q8(std::chrono::nanoseconds) {
        return any_turn;
    }
    static void decode(const FinishedCapsule<packet_size(type)>& capsule, Sample* sample);
    static void restart() {}
};

extern template class CapsuleDecoder<ExpressFormat>;
using ExpressDecoder = CapsuleDecoder<ExpressFormat>;

}  // namespace sweepcast::protocol
