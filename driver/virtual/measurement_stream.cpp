#include "driver/virtual/measurement_stream.hpp"

#include "driver/protocol/encode_express.hpp"
#include "driver/protocol/encode_normal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace sweepcast::virtual_lidar {

namespace {

constexpr int q6_per_turn = 360 * 64;

protocol::AngleQ6 head_angle(double turns) {
    const double part = turns - std::floor(turns);
    const auto q6 = std::min(static_cast<int>(part * q6_per_turn), q6_per_turn - 1);
    return {static_cast<std::uint16_t>(q6)};
}

// A triangulating scanner sees an echo at an angle that depends on its distance, which capsules
// tell as an offset to the evenly spread angle. The vendor's own formula for it (protocol.md 7.5):
// 8 degrees for what is far away, less by asin(24 mm / distance), and 7.5 degrees below 50 mm or
// without an echo.
std::uint8_t angle_offset_q3(std::optional<double> distance_mm) {
    constexpr double base_mm = 98361.0 / 4096.0;
    constexpr double nearest_mm = 50.0;
    double offset_deg = 7.5;
    if (distance_mm && *distance_mm >= nearest_mm) {
        offset_deg = 8.0 - std::asin(base_mm / *distance_mm) * (180.0 / std::numbers::pi);
    }
    return static_cast<std::uint8_t>(std::clamp(std::lround(offset_deg * 8.0), 0L, 63L));
}

// The angle that a receiver will compute (protocol.md 7.3): raw is in 1/65536 degree.
double corrected_angle_deg(std::int64_t raw_q16, std::uint8_t offset_q3) {
    const std::int64_t q6 = (raw_q16 - (std::int64_t{offset_q3} << 13)) >> 10;
    return static_cast<double>(q6) / 64.0;
}

// Measures where the receiver will say that it was measured. Angle and distance depend on each
// other: the offset for what is seen from the angle of a far wall is as near as it needs to be,
// since the distance is then measured at the final angle.
protocol::ExpressSample express_sample(Beam& beam, std::int64_t raw_q16, Seconds t) {
    const double first_guess_deg = corrected_angle_deg(raw_q16, angle_offset_q3(std::nullopt));
    const auto offset_q3 = angle_offset_q3(beam.true_distance_mm(first_guess_deg, t));
    const auto echo = beam.measure(corrected_angle_deg(raw_q16, offset_q3), t);
    return {static_cast<std::uint16_t>(std::lround(echo.distance_mm)), offset_q3};
}

}  // namespace

bool can_stream(protocol::AnswerType type) {
    return type == protocol::AnswerType::normal || type == protocol::AnswerType::express;
}

MeasurementStream::MeasurementStream(const ScanMode& mode, const Motor& motor, Moment first_sample)
    : mode_(mode)
    , packet_start_(first_sample)
    , start_turns_(motor.turns(first_sample))
    , previous_turns_(start_turns_) {
    if (!can_stream(mode.answer)) {
        throw std::invalid_argument("a scan mode whose answer type cannot be streamed");
    }
}

int MeasurementStream::samples_per_packet() const {
    return mode_.answer == protocol::AnswerType::express
               ? static_cast<int>(protocol::express_samples_per_capsule)
               : 1;
}

Moment MeasurementStream::packet_end() const {
    return packet_start_ + mode_.sample_duration() * samples_per_packet();
}

Moment MeasurementStream::packet_ready() const {
    return packet_end() + mode_.sample_duration() / 2;
}

const std::vector<std::uint8_t>&
MeasurementStream::measure(const Motor& motor, Beam& beam, Moment switched_on) {
    const double end_turns = motor.turns(packet_end());
    if (mode_.answer == protocol::AnswerType::express) {
        measure_express(beam, switched_on, end_turns);
    } else {
        measure_normal(beam, switched_on);
    }
    packet_start_ = packet_end();
    previous_turns_ = start_turns_;
    start_turns_ = end_turns;
    restarted_ = false;
    return bytes_;
}

void MeasurementStream::measure_normal(Beam& beam, Moment switched_on) {
    const auto angle = head_angle(start_turns_);
    const auto echo = beam.measure(angle.degrees(), packet_start_ - switched_on);
    const auto packet = protocol::encode_normal({
        .starts_revolution = std::floor(start_turns_) > std::floor(previous_turns_),
        .quality6 = echo.quality6,
        .angle = angle,
        .distance_q2 = static_cast<std::uint16_t>(std::lround(echo.distance_mm * 4.0)),
    });
    bytes_.assign(packet.begin(), packet.end());
}

void MeasurementStream::measure_express(Beam& beam, Moment switched_on, double end_turns) {
    protocol::ExpressCapsule capsule{
        .restart = restarted_,
        .start_angle = head_angle(start_turns_),
        .samples = {}};
    const int start_q6 = capsule.start_angle.raw;
    int step_q6 = head_angle(end_turns).raw - start_q6;
    if (step_q6 < 0) {
        step_q6 += q6_per_turn;
    }
    // Spread as a receiver will: start in q16, 32 steps to the next start (protocol.md 7.2, 7.3).
    for (std::size_t k = 0; k < capsule.samples.size(); ++k) {
        const auto index = static_cast<std::int64_t>(k);
        const std::int64_t raw_q16 = (std::int64_t{start_q6} << 10) + index * (step_q6 << 5);
        const Seconds t = packet_start_ + index * mode_.sample_duration() - switched_on;
        capsule.samples[k] = express_sample(beam, raw_q16, t);
    }
    const auto packet = protocol::encode_express(capsule);
    bytes_.assign(packet.begin(), packet.end());
}

}  // namespace sweepcast::virtual_lidar
