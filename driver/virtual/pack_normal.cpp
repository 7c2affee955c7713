// Answer type 0x81: a packet a sample, with the angle that the head has.
#include "driver/protocol/encode_normal.hpp"
#include "driver/virtual/packer.hpp"

#include <cmath>

namespace sweepcast::virtual_lidar {

namespace {

constexpr double normal_field_mm = 16383.75;

class NormalPacker final : public Packer {
public:
    [[nodiscard]] std::size_t samples() const override { return 1; }

    const std::vector<std::uint8_t>& pack(const Stretch& stretch, Beam& beam) override {
        const auto angle = stretch.start_angle();
        const auto echo = stretch.measure(beam, angle.degrees(), 0, normal_field_mm);
        const auto packet = protocol::encode_normal({
            .starts_revolution = std::floor(stretch.start_turns) > std::floor(stretch.turns_before),
            .quality6 = echo.quality6,
            .angle = angle,
            .distance_q2 = static_cast<std::uint16_t>(std::lround(echo.distance_mm * 4.0)),
        });
        bytes_.assign(packet.begin(), packet.end());
        return bytes_;
    }

private:
    std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<Packer> make_normal_packer() {
    return std::make_unique<NormalPacker>();
}

}  // namespace sweepcast::virtual_lidar
