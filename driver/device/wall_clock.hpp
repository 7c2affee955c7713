// WallClock: how UNIX time relates to the monotonic clock, and when it was set anew.
#pragma once

#include <chrono>
#include <optional>

namespace sweepcast::device {

/// Both clocks, read at the same time.
struct ClockReading {
    std::chrono::nanoseconds monotonic{};
    std::chrono::nanoseconds unix{};
    std::chrono::nanoseconds width{};  ///< how far apart the two may have been read
};

/// Reads them; again, a few times, if it took long.
[[nodiscard]] ClockReading read_clocks();

/// What UNIX time is, from reading to reading.
class WallClock {
public:
    struct Relation {
        std::chrono::nanoseconds monotonic_to_unix{};  ///< add it to a monotonic time
        /// By how much UNIX time was set forward since the reading before, negative: back; 0: it
        /// was not.
        std::chrono::nanoseconds step{};
    };

    /// Takes a reading. Daemons that keep the time right let it run faster or slower by up to 500
    /// millionths: more than that is a step, and so is the time that the machine was suspended.
    Relation take(const ClockReading& reading);

private:
    std::optional<ClockReading> last_;
};

}  // namespace sweepcast::device
