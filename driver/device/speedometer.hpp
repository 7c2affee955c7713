// Speedometer: how fast a lidar turns, from the time of its revolutions. Pure.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace sweepcast::device {

/// The mean over the last revolutions, at most six: long enough to average out the jitter of
/// arrival times (0.3 ms of 100), short enough to show a change within a second.
class Speedometer {
public:
    /// So many revolutions count.
    static constexpr std::uint32_t most = 6;

    /// Takes the time of one revolution in; one that is not positive is not counted.
    void add(std::chrono::microseconds revolution);

    /// Begins anew: what came before was another speed.
    void forget() { count_ = 0; }

    /// Turns a second; 0 before the first revolution.
    [[nodiscard]] double hz() const;

    /// Whether the speed does not change any more: the last three revolutions took as long as the
    /// three before, within 0.4 %. False before there were six.
    [[nodiscard]] bool steady() const;

private:
    static constexpr std::size_t half = most / 2;

    [[nodiscard]] std::chrono::microseconds total(std::size_t from, std::size_t to) const;

    std::array<std::chrono::microseconds, most> last_{};  ///< the latest at the end
    std::size_t count_{};
};

/// Whether a lidar turns as wanted: within 2 %. False unless both are known.
[[nodiscard]] bool speed_is_met(double measured_hz, double wanted_hz);

}  // namespace sweepcast::device
