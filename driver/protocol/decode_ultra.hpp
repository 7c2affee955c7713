// Bytes of answer type 0x84 (ultra) -> samples.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/capsule_decoder.hpp"
#include "driver/protocol/ultra_code.hpp"

namespace sweepcast::protocol {

/// What the bytes of an ultra capsule mean: 32 cabins of three samples, told relative to one
/// another, the last one relative to the next capsule's first. Source: protocol.md 7.5.
///
/// A negative distance comes out as 0, no echo. If the next capsule was lost, so is the reference
/// of the last cabin: its third sample, and its second if its first has no echo, come out as no
/// echo. The flag may miss the beginning of a revolution, as the vendor's does: an increment is
/// rounded down, and a turn that ends between two capsules is in neither.
class UltraFormat {
public:
    static constexpr AnswerType type = AnswerType::ultra;
    static constexpr std::size_t samples_per_capsule = ultra_samples_per_capsule;
    static constexpr std::size_t start_word_at = 2;

    [[nodiscard]] static constexpr std::int32_t greatest_turn_q8(std::chrono::nanoseconds) {
        return any_turn;
    }
    static void decode(const FinishedCapsule<packet_size(type)>& capsule, Sample* sample);
    static void restart() {}
};

extern template class CapsuleDecoder<UltraFormat>;
using UltraDecoder = CapsuleDecoder<UltraFormat>;

}  // namespace sweepcast::protocol
