// Samples -> capsules of answer type 0x84.
#include "driver/protocol/encode_ultra.hpp"

#include "driver/protocol/capsule.hpp"
#include "driver/protocol/wire.hpp"

#include <bit>
#include <span>

namespace sweepcast::protocol {
namespace {

/// The code nearest to a distance; 0, no echo, if none is near.
std::int32_t nearest_code(std::int32_t mm) {
    auto scale = ultra_scales[0];
    for (const auto& next : ultra_scales) {
        scale = mm >= next.first_mm ? next : scale;
    }
    // Rounding up beyond the last code of a scale gives the first of the next one, as it should.
    const auto half_step = (1 << scale.level) / 2;
    const auto code = scale.first_code + ((mm - scale.first_mm + half_step) >> scale.level);
    return code <= ultra_last_code ? code : 0;
}

/// The difference that makes `mm` out of `base`, as nearly as can be.
std::int32_t nearest_difference(std::int32_t mm, const UltraMajor& base) {
    if (mm == 0) {
        return ultra_no_echo;
    }
    auto steps =
        (mm - base.mm + base.step / 2) >> std::countr_zero(static_cast<unsigned>(base.step));
    if (base.mm + steps * base.step <= 0) {
        ++steps;  // 0 would say that there is no echo
    }
    return steps > ultra_no_echo && steps < ultra_no_echo_too ? steps : ultra_no_echo;
}

std::uint32_t low_bits(std::int32_t value, unsigned count) {
    return static_cast<std::uint32_t>(value) & ((1U << count) - 1U);
}

}  // namespace

std::array<std::uint8_t, packet_size(AnswerType::ultra)>
encode_ultra(const UltraCapsule& capsule, std::uint16_t next_distance_mm) {
    std::array<std::uint8_t, packet_size(AnswerType::ultra)> packet{};
    const std::span bytes{packet};
    store_start_word(bytes.subspan<2, 2>(), capsule.restart, capsule.start_angle);
    auto code = nearest_code(capsule.distances_mm[0]);
    for (std::size_t cabin = 0; cabin < ultra_cabins_per_capsule; ++cabin) {
        const auto first = 3 * cabin;
        const bool last = cabin + 1 == ultra_cabins_per_capsule;
        const auto next_code =
            nearest_code(last ? next_distance_mm : capsule.distances_mm[first + 3]);
        const auto next_major = ultra_major(next_code);
        const auto own_major = code != 0 ? ultra_major(code) : next_major;
        const auto second = nearest_difference(capsule.distances_mm[first + 1], own_major);
        const auto third = nearest_difference(capsule.distances_mm[first + 2], next_major);
        store_le32(
            bytes.subspan(4 + 4 * cabin).first<4>(),
            low_bits(code, 12) | low_bits(second, 10) << 12 | low_bits(third, 10) << 22
        );
        code = next_code;
    }
    seal_capsule(bytes);
    return packet;
}

}  // namespace sweepcast::protocol
