#include "driver/virtual/packer.hpp"

#include "driver/protocol/capsule.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sweepcast::virtual_lidar {

namespace {

protocol::AngleQ6 head_angle(double turns) {
    const double part = turns - std::floor(turns);
    const auto q6 = std::min(static_cast<int>(part * protocol::turn_q6), protocol::turn_q6 - 1);
    return {static_cast<std::uint16_t>(q6)};
}

}  // namespace

protocol::AngleQ6 Stretch::start_angle() const {
    return head_angle(start_turns);
}

protocol::AngleQ6 Stretch::end_angle() const {
    return head_angle(end_turns);
}

std::int64_t Stretch::spread_q16(std::size_t k) const {
    const auto start = start_angle();
    const std::int64_t turned_q16 = std::int64_t{protocol::turned_q8(start, end_angle())} << 8;
    const auto step_q16 = turned_q16 / static_cast<std::int64_t>(samples);
    return (std::int64_t{start.raw} << 10) + static_cast<std::int64_t>(k) * step_q16;
}

double Stretch::turns(std::size_t k) const {
    const double part = static_cast<double>(k) / static_cast<double>(samples);
    return start_turns + part * (end_turns - start_turns);
}

Seconds Stretch::time(std::size_t k) const {
    return start_time + static_cast<double>(k) * sample_duration;
}

Echo Stretch::measure(Beam& beam, double angle_deg, std::size_t k, double field_mm) const {
    const auto echo = beam.measure(angle_deg, time(k));
    return echo.distance_mm <= std::min(max_distance_mm, field_mm) ? echo : Echo{};
}

double received_degrees(std::int64_t raw_q16) {
    return static_cast<double>(raw_q16 >> 10) / 64.0;
}

std::unique_ptr<Packer> make_packer(protocol::AnswerType type) {
    switch (type) {
    case protocol::AnswerType::normal:
        return make_normal_packer();
    case protocol::AnswerType::express:
        return make_express_packer();
    case protocol::AnswerType::hq:
        return make_hq_packer();
    case protocol::AnswerType::ultra:
        return make_ultra_packer();
    case protocol::AnswerType::dense:
        return make_dense_packer();
    case protocol::AnswerType::ultra_dense:
        return make_ultra_dense_packer();
    }
    throw std::invalid_argument("a scan mode whose answer type cannot be streamed");
}

}  // namespace sweepcast::virtual_lidar
