// Bytes of answer type 0x85 (dense) -> samples.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/capsule_angles.hpp"
#include "driver/protocol/capsule_decoder.hpp"
#include "driver/protocol/encode_dense.hpp"

namespace sweepcast::protocol {

/// What the bytes of a dense capsule mean: 40 distances. Source: protocol.md 7.6.
class DenseFormat {
public:
    static constexpr AnswerType type = AnswerType::dense;
    static constexpr std::size_t samples_per_capsule = dense_samples_per_capsule;
    static constexpr std::size_t start_word_at = 2;

    [[nodiscard]] static constexpr std::int32_t greatest_turn_q8(std::chrono::nanoseconds duration
    ) {
        return dense_turn_limit_q8(40, duration);
    }
    void decode(const FinishedCapsule<packet_size(type)>& capsule, Sample* sample);
    void restart() { mark_ = {}; }

private:
    DenseMark mark_;
};

extern template class CapsuleDecoder<DenseFormat>;
using DenseDecoder = CapsuleDecoder<DenseFormat>;

}  // namespace sweepcast::protocol
