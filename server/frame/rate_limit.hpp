// RateLimit: leaves sweeps out so that no more than so many a second go out.
#pragma once

#include "driver/protocol/units.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

namespace sweepcast::frame {

/// Evenly: one goes out as soon as it is due on average, so a speed that wavers a little does not
/// cost every other sweep.
class RateLimit {
public:
    /// On average `interval` from one to the next; 0: no limit.
    explicit RateLimit(std::chrono::microseconds interval) : interval_(interval) {}

    /// Whether the sweep that begins then, and takes so long, goes out. Times grow, but for a lidar
    /// that was faster than it said (it flooded its line) and is begun anew: it counts from there.
    bool lets_pass(protocol::SampleTime begin, std::chrono::microseconds period) {
        if (begin < last_) {
            due_.reset();
        }
        last_ = begin;
        if (due_ && begin < *due_ - std::min(interval_, period) / 4) {
            return false;
        }
        // One that comes late does not put off those after it, unless it is a whole turn late.
        const bool in_time = due_ && begin - *due_ < interval_;
        due_ = (in_time ? *due_ : begin) + interval_;
        return true;
    }

private:
    std::chrono::microseconds interval_;
    protocol::SampleTime last_{};
    std::optional<protocol::SampleTime> due_;
};

}  // namespace sweepcast::frame
