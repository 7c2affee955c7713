// Answer type 0x85: capsules of 40 samples, evenly spread.
#include "driver/protocol/encode_dense.hpp"
#include "driver/virtual/packer.hpp"

#include <cmath>

namespace sweepcast::virtual_lidar {

namespace {

constexpr double dense_field_mm = 65535.0;

class DensePacker final : public Packer {
public:
    [[nodiscard]] std::size_t samples() const override {
        return protocol::dense_samples_per_capsule;
    }

    const std::vector<std::uint8_t>& pack(const Stretch& stretch, Beam& beam) override {
        protocol::DenseCapsule capsule{
            .restart = stretch.restarted,
            .start_angle = stretch.start_angle(),
            .distances_mm = {}};
        for (std::size_t k = 0; k < capsule.distances_mm.size(); ++k) {
            const double angle_deg = received_degrees(stretch.spread_q16(k));
            const auto echo = stretch.measure(beam, angle_deg, k, dense_field_mm);
            capsule.distances_mm[k] = static_cast<std::uint16_t>(std::lround(echo.distance_mm));
        }
        const auto packet = protocol::encode_dense(capsule);
        bytes_.assign(packet.begin(), packet.end());
        return bytes_;
    }

private:
    std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<Packer> make_dense_packer() {
    return std::make_unique<DensePacker>();
}

}  // namespace sweepcast::virtual_lidar
