// Answer type 0x83: packets of 96 samples that say everything themselves.
#include "driver/protocol/encode_hq.hpp"
#include "driver/virtual/packer.hpp"

#include <cmath>
#include <limits>

namespace sweepcast::virtual_lidar {

namespace {

constexpr double hq_field_mm = std::numeric_limits<std::uint32_t>::max() / 4.0;

protocol::AngleQ14 angle_of(double turns) {
    constexpr double steps_per_turn = 65536.0;
    return {static_cast<std::uint16_t>((turns - std::floor(turns)) * steps_per_turn)};
}

class HqPacker final : public Packer {
public:
    [[nodiscard]] std::size_t samples() const override { return protocol::hq_samples_per_packet; }

    const std::vector<std::uint8_t>& pack(const Stretch& stretch, Beam& beam) override {
        using std::chrono::microseconds;
        const auto clock = std::chrono::round<microseconds>(stretch.start_time);
        protocol::HqPacket packet{
            .time_stamp = static_cast<std::uint64_t>(clock.count()),
            .samples = {}};
        double turns_before = stretch.turns_before;
        for (std::size_t k = 0; k < packet.samples.size(); ++k) {
            const double turns = stretch.turns(k);
            const auto angle = angle_of(turns);
            const auto echo = stretch.measure(beam, angle.degrees(), k, hq_field_mm);
            packet.samples[k] = {
                .angle = angle,
                .distance = {static_cast<std::uint32_t>(std::lround(echo.distance_mm * 4.0))},
                .quality = static_cast<std::uint8_t>(echo.quality6 << 2),
                .flag = static_cast<std::uint8_t>(std::floor(turns) > std::floor(turns_before)),
            };
            turns_before = turns;
        }
        const auto encoded = protocol::encode_hq(packet);
        bytes_.assign(encoded.begin(), encoded.end());
        return bytes_;
    }

private:
    std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<Packer> make_hq_packer() {
    return std::make_unique<HqPacker>();
}

}  // namespace sweepcast::virtual_lidar
