#include "driver/virtual/measurement_stream.hpp"

namespace sweepcast::virtual_lidar {

MeasurementStream::MeasurementStream(const ScanMode& mode, const Motor& motor, Moment first_sample)
    : mode_(mode)
    , packer_(make_packer(mode.answer))
    , packet_start_(first_sample)
    , start_turns_(motor.turns(first_sample))
    , turns_before_(start_turns_) {}

Moment MeasurementStream::packet_end() const {
    return packet_start_ + mode_.sample_duration() * static_cast<std::int64_t>(packer_->samples());
}

Moment MeasurementStream::packet_ready() const {
    return packet_end() + mode_.sample_duration() / 2;
}

void MeasurementStream::restart_angle() {
    restarted_ = true;
    turns_before_ = start_turns_ - 1.0;  // what is marked by revolution is marked too
}

const std::vector<std::uint8_t>&
MeasurementStream::measure(const Motor& motor, Beam& beam, Moment switched_on) {
    constexpr double q8 = 256.0;
    constexpr double mm_per_m = 1000.0;
    const Stretch stretch{
        .samples = packer_->samples(),
        .start_turns = start_turns_,
        .end_turns = motor.turns(packet_end()),
        .turns_before = turns_before_,
        .restarted = restarted_,
        .start_time = packet_start_ - switched_on,
        .sample_duration = mode_.sample_duration(),
        .max_distance_mm = mode_.max_distance_q8_m / q8 * mm_per_m,
    };
    packet_start_ = packet_end();
    start_turns_ = stretch.end_turns;
    turns_before_ = stretch.turns(stretch.samples - 1);
    restarted_ = false;
    return packer_->pack(stretch, beam);
}

}  // namespace sweepcast::virtual_lidar
