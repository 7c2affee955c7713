// Express capsules -> samples.
#include "driver/protocol/decode_express.hpp"

#include "driver/protocol/capsule_angles.hpp"
#include "driver/protocol/wire.hpp"

namespace sweepcast::protocol {

template class CapsuleDecoder<ExpressFormat>;

void ExpressFormat::decode(const FinishedCapsule<packet_size(type)>& capsule, Sample* sample) {
    CapsuleAngles angles{capsule.start, capsule.turned_q8 * 8};
    auto time = capsule.first_sample;
    const auto put = [&](unsigned word, unsigned offset_q3) {
        const auto corrected = angles.raw_q16() - static_cast<std::int32_t>(offset_q3) * 8192;
        angles.advance();
        sample->time = to_sample_time(time);
        sample->distance.raw = word & 0xFFFCU;
        sample->angle = angle_from_q6(corrected >> 10);
        sample->quality = sample->distance.has_echo() ? quality_with_echo : 0;
        sample->flag = capsule_flag(angles.passed_zero_within(1));
        time += capsule.sample_duration;
        ++sample;
    };
    for (std::size_t at = 4; at < capsule.bytes.size(); at += 5) {
        const unsigned word1 = load_le16(capsule.bytes.subspan(at).first<2>());
        const unsigned word2 = load_le16(capsule.bytes.subspan(at + 2).first<2>());
        const unsigned offsets = capsule.bytes[at + 4];
        put(word1, (offsets & 15U) | (word1 & 3U) << 4);
        put(word2, offsets >> 4 | (word2 & 3U) << 4);
    }
}

}  // namespace sweepcast::protocol
