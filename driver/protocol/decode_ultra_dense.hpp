// Bytes of answer type 0x86 (ultra-dense) -> samples.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/capsule_angles.hpp"
#include "driver/protocol/capsule_decoder.hpp"
#include "driver/protocol/ultra_dense_code.hpp"

namespace sweepcast::protocol {

/// What the bytes of an ultra-dense capsule mean: 32 cabins of two samples with distance and
/// quality. A near distance is averaged with the one before it, across capsules too, if the two are
/// close. Source: protocol.md 7.7.
class UltraDenseFormat {
public:
    static constexpr AnswerType type = AnswerType::ultra_dense;
    static constexpr std::size_t samples_per_capsule = ultra_dense_samples_per_capsule;
    static constexpr std::size_t start_word_at = ultra_dense_start_at;

    [[nodiscard]] static constexpr std::int32_t greatest_turn_q8(std::chrono::nanoseconds duration
    ) {
        return dense_turn_limit_q8(32, duration);  // 32 although there are 64 samples
    }
    void decode(const FinishedCapsule<packet_size(type)>& capsule, Sample* sample);
    void restart() { *this = {}; }

private:
    DenseMark mark_;
    std::int32_t last_distance_q2_{};
};

extern template class CapsuleDecoder<UltraDenseFormat>;
using UltraDenseDecoder = CapsuleDecoder<UltraDenseFormat>;

}  // namespace sweepcast::protocol
