// Dense capsules -> samples.
#include "driver/protocol/decode_dense.hpp"

#include "driver/protocol/wire.hpp"

namespace sweepcast::protocol {

template class CapsuleDecoder<DenseFormat>;

void DenseFormat::decode(const FinishedCapsule<packet_size(type)>& capsule, Sample* sample) {
    CapsuleAngles angles{capsule.start, capsule.turned_q8 * 256 / 40};
    auto time = capsule.first_sample;
    auto mark = mark_;
    for (std::size_t at = 4; at < capsule.bytes.size(); at += 2, ++sample) {
        sample->time = to_sample_time(time);
        sample->distance.raw = load_le16(capsule.bytes.subspan(at).first<2>()) * 4U;
        sample->angle = angle_from_q6(angles.raw_q16() >> 10);
        sample->quality = sample->distance.has_echo() ? quality_with_echo : 0;
        angles.advance();
        sample->flag = capsule_flag(mark.take(angles));
        time += capsule.sample_duration;
    }
    mark_ = mark;
}

}  // namespace sweepcast::protocol
