// CapsuleAngles: the evenly spread angles of a capsule's samples, one after the other.
#pragma once

#include "driver/protocol/capsule.hpp"
#include "driver/protocol/units.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace sweepcast::protocol {

/// The raw angle of one sample after the other. Source: protocol.md 7.2.
class CapsuleAngles {
public:
    /// From `start` on, by `increment_q16` a sample: less than a turn, and backward at most to 0.
    CapsuleAngles(AngleQ6 start, std::int32_t increment_q16)
        : increment_(increment_q16)
        , raw_(start.raw * 1024)
        , in_turn_(raw_ % turn_q16) {}

    /// The angle of this sample in 1/65536 degree, not wrapped.
    [[nodiscard]] std::int32_t raw_q16() const { return raw_; }

    /// Goes on to the next sample.
    void advance() {
        raw_ += increment_;
        in_turn_ += increment_;
        in_turn_ -= in_turn_ >= turn_q16 ? turn_q16 : 0;
    }

    /// Whether heading 0 lies less than `count` increments back (`next raw % turn < count *
    /// increment`, as the vendor tests it).
    [[nodiscard]] bool passed_zero_within(std::int32_t count) const {
        return in_turn_ < count * increment_;
    }

private:
    std::int32_t increment_;
    std::int32_t raw_;
    std::int32_t in_turn_;
};

/// Marks the beginnings of revolutions in dense streams. The window of two increments cannot miss
/// one between two capsules; what it hits twice counts once. Source: protocol.md 7.6.
class DenseMark {
public:
    /// Whether a revolution begins with the sample before the one at `angles`.
    [[nodiscard]] bool take(const CapsuleAngles& angles) {
        last_ = angles.passed_zero_within(2) && !last_;
        return last_;
    }

private:
    bool last_{};
};

/// Quality of a sample of a type that does not measure it.
inline constexpr std::uint8_t quality_with_echo = 0x2F << 2;

/// The flag of a capsule's sample: bit 0, first of a revolution, or else bit 1.
[[nodiscard]] constexpr std::uint8_t capsule_flag(bool starts_revolution) {
    return starts_revolution ? 1 : 2;
}

/// The greatest turn in 1/256 degree that dense capsules of so many samples are decoded for; what
/// is faster than 100 Hz is nonsense. Without a sample duration (0) there is no such limit. Source:
/// protocol.md 7.6, 7.7.
[[nodiscard]] constexpr std::int32_t
dense_turn_limit_q8(std::int32_t samples, std::chrono::nanoseconds sample_duration) {
    if (sample_duration.count() < 1) {
        return any_turn;
    }
    const auto samples_per_second =
        std::max<std::int64_t>(std::chrono::seconds{1} / sample_duration, 1);
    return static_cast<std::int32_t>(36'000 * samples / samples_per_second) << 8;
}

}  // namespace sweepcast::protocol
