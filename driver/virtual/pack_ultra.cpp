// Answer type 0x84: capsules of 96 samples, whose angles a receiver corrects by their distances.
#include "driver/protocol/encode_ultra.hpp"
#include "driver/virtual/packer.hpp"

#include <cmath>

namespace sweepcast::virtual_lidar {

namespace {

// The last code of the variable scale.
constexpr double ultra_field_mm = 28656.0;

double ultra_angle_deg(std::int64_t raw_q16, std::optional<double> distance_mm) {
    const auto distance_q2 = static_cast<std::int32_t>(std::lround(distance_mm.value_or(0) * 4.0));
    return received_degrees(raw_q16 - protocol::ultra_angle_offset_q16(distance_q2));
}

// Measures where the receiver will say that it was measured. Angle and distance depend on each
// other: three rounds settle it, but for edges, where a beam may hit the wrong side.
std::uint16_t ultra_sample(const Stretch& stretch, Beam& beam, std::size_t k) {
    constexpr int rounds = 3;
    const auto raw_q16 = stretch.spread_q16(k);
    std::optional<double> distance_mm = ultra_field_mm;
    for (int round = 0; round < rounds; ++round) {
        distance_mm = beam.true_distance_mm(ultra_angle_deg(raw_q16, distance_mm), stretch.time(k));
    }
    const auto echo =
        stretch.measure(beam, ultra_angle_deg(raw_q16, distance_mm), k, ultra_field_mm);
    return static_cast<std::uint16_t>(std::lround(echo.distance_mm));
}

class UltraPacker final : public Packer {
public:
    [[nodiscard]] std::size_t samples() const override {
        return protocol::ultra_samples_per_capsule;
    }

    // The last sample is told relative to the first one of the next capsule, which is therefore
    // measured here already.
    const std::vector<std::uint8_t>& pack(const Stretch& stretch, Beam& beam) override {
        protocol::UltraCapsule capsule{
            .restart = stretch.restarted,
            .start_angle = stretch.start_angle(),
            .distances_mm = {}};
        capsule.distances_mm[0] = first_mm_ ? *first_mm_ : ultra_sample(stretch, beam, 0);
        for (std::size_t k = 1; k < capsule.distances_mm.size(); ++k) {
            capsule.distances_mm[k] = ultra_sample(stretch, beam, k);
        }
        first_mm_ = ultra_sample(next_start(stretch), beam, 0);
        const auto packet = protocol::encode_ultra(capsule, *first_mm_);
        bytes_.assign(packet.begin(), packet.end());
        return bytes_;
    }

private:
    // Where the next stretch begins; a receiver takes its first sample from there, however long it
    // is.
    static Stretch next_start(const Stretch& stretch) {
        Stretch next = stretch;
        next.start_turns = stretch.end_turns;
        next.start_time = stretch.time(stretch.samples);
        return next;
    }

    std::optional<std::uint16_t> first_mm_;
    std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<Packer> make_ultra_packer() {
    return std::make_unique<UltraPacker>();
}

}  // namespace sweepcast::virtual_lidar
