// Answer type 0x82: capsules of 32 samples, each with its own offset to the evenly spread angle.
#include "driver/protocol/encode_express.hpp"
#include "driver/virtual/packer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sweepcast::virtual_lidar {

namespace {

constexpr double express_field_mm = 16383.0;

// A triangulating scanner sees an echo at an angle that depends on its distance, which these
// capsules tell as an offset. The vendor's own formula for it (protocol.md 7.5): 8 degrees for what
// is far away, less by asin(24 mm / distance), and 7.5 degrees below 50 mm or without an echo.
std::uint8_t angle_offset_q3(std::optional<double> distance_mm) {
    constexpr double base_mm = 98361.0 / 4096.0;
    constexpr double nearest_mm = 50.0;
    double offset_deg = 7.5;
    if (distance_mm && *distance_mm >= nearest_mm) {
        offset_deg = 8.0 - std::asin(base_mm / *distance_mm) * (180.0 / std::numbers::pi);
    }
    return static_cast<std::uint8_t>(std::clamp(std::lround(offset_deg * 8.0), 0L, 63L));
}

// The angle that a receiver will compute (protocol.md 7.3).
double express_angle_deg(std::int64_t raw_q16, std::uint8_t offset_q3) {
    return received_degrees(raw_q16 - (std::int64_t{offset_q3} << 13));
}

// Measures where the receiver will say that it was measured. Angle and distance depend on each
// other: the offset for what is seen from the angle of a far wall is as near as it needs to be,
// since the distance is then measured at the final angle.
protocol::ExpressSample express_sample(const Stretch& stretch, Beam& beam, std::size_t k) {
    const auto raw_q16 = stretch.spread_q16(k);
    const double first_guess_deg = express_angle_deg(raw_q16, angle_offset_q3(std::nullopt));
    const auto offset_q3 = angle_offset_q3(beam.true_distance_mm(first_guess_deg, stretch.time(k)));
    const auto echo =
        stretch.measure(beam, express_angle_deg(raw_q16, offset_q3), k, express_field_mm);
    return {static_cast<std::uint16_t>(std::lround(echo.distance_mm)), offset_q3};
}

class ExpressPacker final : public Packer {
public:
    [[nodiscard]] std::size_t samples() const override {
        return protocol::express_samples_per_capsule;
    }

    const std::vector<std::uint8_t>& pack(const Stretch& stretch, Beam& beam) override {
        protocol::ExpressCapsule capsule{
            .restart = stretch.restarted,
            .start_angle = stretch.start_angle(),
            .samples = {}};
        for (std::size_t k = 0; k < capsule.samples.size(); ++k) {
            capsule.samples[k] = express_sample(stretch, beam, k);
        }
        const auto packet = protocol::encode_express(capsule);
        bytes_.assign(packet.begin(), packet.end());
        return bytes_;
    }

private:
    std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<Packer> make_express_packer() {
    return std::make_unique<ExpressPacker>();
}

}  // namespace sweepcast::virtual_lidar
