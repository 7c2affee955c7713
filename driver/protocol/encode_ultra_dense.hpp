// Samples -> capsules of answer type 0x86 (ultra-dense), for the virtual lidar.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/ultra_dense_code.hpp"
#include "driver/protocol/units.hpp"

#include <array>
#include <cstdint>

namespace sweepcast::protocol {

/// One sample of an ultra-dense capsule.
struct UltraDenseSample {
    std::uint16_t distance_mm{};  ///< 0: no echo
    std::uint8_t quality{};       ///< 0..255; far samples keep its highest bits only
};

/// What one ultra-dense capsule holds.
struct UltraDenseCapsule {
    std::uint32_t time_stamp{};  ///< the device's clock
    std::uint16_t status{};      ///< the device's status
    bool restart{};              ///< the angle reference was restarted: first capsule of a stream
    AngleQ6 start_angle{};  ///< of the first sample, 15 bits; the others lie evenly up to the next
                            ///< capsule's
    std::array<UltraDenseSample, ultra_dense_samples_per_capsule> samples{};
};

/// The 170 bytes of a capsule. Source: protocol.md 7.2, 7.7.
///
/// Distances are rounded to the nearest step, an echo never to 0: at most 1 mm off up to 8187 mm,
/// 2 mm up to 65522; the 13 mm beyond come out as 65522. A receiver averages each one up to 2046 mm
/// with the one before it if they are within 2 mm, which moves it by another 1 mm at most. Of the
/// quality 8 bits are kept up to 2046 mm, 7 up to 8187, 6 up to 24567 and 5 beyond.
[[nodiscard]] std::array<std::uint8_t, packet_size(AnswerType::ultra_dense)> encode_ultra_dense(
    const UltraDenseCapsule& capsule
);

}  // namespace sweepcast::protocol
