// OncePerSecond: keeps what happens often from filling the log.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <utility>

namespace sweepcast::net {

/// Counts events of one kind. The first is reported at once, those after it at most once a second
/// and together.
class OncePerSecond {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// Counts an event at `now`. How many there have been since the last report if one is due, else
    /// nothing.
    [[nodiscard]] std::optional<std::size_t> count(Time now) {
        ++unreported_;
        if (reported_at_ && now - *reported_at_ < std::chrono::seconds(1)) {
            return std::nullopt;
        }
        reported_at_ = now;
        return std::exchange(unreported_, 0);
    }

private:
    std::optional<Time> reported_at_;
    std::size_t unreported_{};
};

}  // namespace sweepcast::net
