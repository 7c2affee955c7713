// Answer type 0x86: capsules of 64 samples, evenly spread, with quality and the scanner's clock.
#include "driver/protocol/encode_ultra_dense.hpp"
#include "driver/virtual/packer.hpp"

#include <cmath>

namespace sweepcast::virtual_lidar {

namespace {

constexpr double ultra_dense_field_mm = 65522.0;

class UltraDensePacker final : public Packer {
public:
    [[nodiscard]] std::size_t samples() const override {
        return protocol::ultra_dense_samples_per_capsule;
    }

    const std::vector<std::uint8_t>& pack(const Stretch& stretch, Beam& beam) override {
        using std::chrono::microseconds;
        const auto clock = std::chrono::round<microseconds>(stretch.start_time);
        protocol::UltraDenseCapsule capsule{
            .time_stamp = static_cast<std::uint32_t>(clock.count()),
            .status = 0,
            .restart = stretch.restarted,
            .start_angle = stretch.start_angle(),
            .samples = {}};
        for (std::size_t k = 0; k < capsule.samples.size(); ++k) {
            const double angle_deg = received_degrees(stretch.spread_q16(k));
            const auto echo = stretch.measure(beam, angle_deg, k, ultra_dense_field_mm);
            capsule.samples[k] = {
                .distance_mm = static_cast<std::uint16_t>(std::lround(echo.distance_mm)),
                .quality = static_cast<std::uint8_t>(echo.quality6 << 2)};
        }
        const auto packet = protocol::encode_ultra_dense(capsule);
        bytes_.assign(packet.begin(), packet.end());
        return bytes_;
    }

private:
    std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<Packer> make_ultra_dense_packer() {
    return std::make_unique<UltraDensePacker>();
}

}  // namespace sweepcast::virtual_lidar
