// SampleTiming: from the arrival of a packet to the moments at which its samples were taken.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/decoded.hpp"
#include "driver/protocol/units.hpp"

#include <chrono>
#include <cstddef>

namespace sweepcast::protocol {

/// When the samples of a packet were taken: t(k) = T - us - us/2 - X - (n-1-k)*us, in whole
/// microseconds. T is the arrival of the packet's last byte, us the sample duration, X the time on
/// the line. Source: protocol.md 8.
class SampleTiming {
public:
    /// Durations outside 0..1 s, which no scanner has, are taken as the nearer limit.
    SampleTiming(AnswerType type, const DecodeSettings& settings);

    /// The time of the last sample of a packet that was complete at `arrival`.
    [[nodiscard]] SampleTime last_sample(SampleTime arrival) const { return arrival - delay_; }
    /// From one sample to the next.
    [[nodiscard]] std::chrono::microseconds sample_duration() const { return sample_duration_; }

private:
    std::chrono::microseconds sample_duration_;
    std::chrono::microseconds delay_;
};

}  // namespace sweepcast::protocol
