// RemoteClock: what another machine's monotonic clock shows, on this one's.
#pragma once

#include "driver/protocol/units.hpp"

#include <chrono>
#include <optional>

namespace sweepcast::gateway {

/// Learns from when samples were taken there and when word of them came here. Of all the ways that
/// a message took, the quickest tells most: it is taken for no time at all, so that a time here is
/// late by as long as the quickest message took. As clocks drift apart, an older one counts for
/// less as time goes by.
class RemoteClock {
public:
    /// A sample taken at `there` was heard of at `here`.
    void hear(protocol::SampleTime there, protocol::SampleTime here);

    /// Add it to a time there to get the time here; 0 until something was heard.
    [[nodiscard]] std::chrono::microseconds offset() const {
        return offset_.value_or(std::chrono::microseconds(0));
    }

private:
    std::optional<std::chrono::microseconds> offset_;
    protocol::SampleTime heard_{};
};

}  // namespace sweepcast::gateway
