// SampleTiming: from the arrival of a packet to the moments at which its samples were taken.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/decoded.hpp"
#include "driver/protocol/units.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace sweepcast::protocol {

/// When the samples of a packet were taken: t(k) = T - d - d/2 - X - (n-1-k)*d, rounded down to
/// whole microseconds. T is the arrival of the packet's last byte, d the sample duration, X the
/// time on the line. With whole microseconds of d these are the vendor's times. The vendor rounds
/// d, which puts the first sample of 40 that are 31.25 us apart 10 us wrong. Source: protocol.md 8.
class SampleTiming {
public:
    /// Takes a duration of more than 1 s, which no scanner has, as 1 s, and one of less than 1 us
    /// as not known, which is 0.
    SampleTiming(AnswerType type, const DecodeSettings& settings);

    /// The time of the last sample of a packet that was complete at `arrival`.
    [[nodiscard]] SampleTime last_sample(SampleTime arrival) const { return arrival - delay_; }
    /// The time of the first of `count` samples, of which `last_sample()` gives the last one's.
    [[nodiscard]] ExactTime first_sample(SampleTime arrival, std::size_t count) const {
        return last_sample(arrival) - static_cast<std::int64_t>(count - 1) * sample_duration_;
    }
    /// The time from one sample to the next.
    [[nodiscard]] std::chrono::nanoseconds sample_duration() const { return sample_duration_; }

private:
    std::chrono::nanoseconds sample_duration_;
    std::chrono::microseconds delay_;
};

}  // namespace sweepcast::protocol
