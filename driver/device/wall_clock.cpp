#include "driver/device/wall_clock.hpp"

#include <algorithm>

namespace sweepcast::device {

namespace {

using std::chrono::nanoseconds;
using namespace std::chrono_literals;

constexpr int most_tries = 4;
constexpr nanoseconds narrow = 5us;
/// A slew gains or loses at most one in so many.
constexpr int slew_part = 2000;
/// What no two readings agree on.
constexpr nanoseconds least_step = 100us;

ClockReading read_once() {
    const nanoseconds before = std::chrono::steady_clock::now().time_since_epoch();
    const nanoseconds unix = std::chrono::system_clock::now().time_since_epoch();
    const nanoseconds after = std::chrono::steady_clock::now().time_since_epoch();
    return {.monotonic = before + (after - before) / 2, .unix = unix, .width = after - before};
}

}  // namespace

ClockReading read_clocks() {
    auto best = read_once();
    for (int i = 1; i < most_tries && best.width > narrow; ++i) {
        best = std::min(best, read_once(), [](const ClockReading& a, const ClockReading& b) {
            return a.width < b.width;
        });
    }
    return best;
}

WallClock::Relation WallClock::take(const ClockReading& reading) {
    Relation relation{.monotonic_to_unix = reading.unix - reading.monotonic};
    if (last_) {
        const auto change = relation.monotonic_to_unix - (last_->unix - last_->monotonic);
        const auto slewed = (reading.monotonic - last_->monotonic) / slew_part;
        if (std::chrono::abs(change) > slewed + reading.width + last_->width + least_step) {
            relation.step = change;
        }
    }
    last_ = reading;
    return relation;
}

}  // namespace sweepcast::device
