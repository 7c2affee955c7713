// Demand: whether a lidar should turn for those who watch. No I/O; times come in as arguments.
#pragma once

#include <chrono>

namespace sweepcast::gateway {

/// Lets a lidar go on for a while after the last one who watched has gone, so that a page that is
/// loaded anew, or a client that reconnects, does not stop its motor.
class Demand {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// Nobody watches from `now` on, unless told otherwise.
    Demand(std::chrono::milliseconds patience, Time now)
        : patience_(patience)
        , last_watched_(now) {}

    /// Takes whether somebody watches now. Returns whether the lidar should turn.
    [[nodiscard]] bool take(bool watched, Time now) {
        if (watched) {
            last_watched_ = now;
        }
        return now - last_watched_ < patience_;
    }

private:
    std::chrono::milliseconds patience_;
    Time last_watched_;
};

}  // namespace sweepcast::gateway
