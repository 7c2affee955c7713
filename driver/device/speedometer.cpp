#include "driver/device/speedometer.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sweepcast::device {

void Speedometer::add(std::chrono::microseconds revolution) {
    if (revolution.count() <= 0) {
        return;
    }
    std::shift_left(last_.begin(), last_.end(), 1);
    last_.back() = revolution;
    count_ = std::min(count_ + 1, last_.size());
}

/// The sum of the revolutions from the `from`th latest to before the `to`th latest, from 0.
std::chrono::microseconds Speedometer::total(std::size_t from, std::size_t to) const {
    const auto begin = last_.rbegin();
    return std::accumulate(
        begin + static_cast<std::ptrdiff_t>(from),
        begin + static_cast<std::ptrdiff_t>(to),
        std::chrono::microseconds{0}
    );
}

double Speedometer::hz() const {
    const std::chrono::duration<double> seconds = total(0, count_);
    return count_ > 0 ? static_cast<double>(count_) / seconds.count() : 0.0;
}

bool Speedometer::steady() const {
    if (count_ < last_.size()) {
        return false;
    }
    const auto late = static_cast<double>(total(0, half).count());
    const auto early = static_cast<double>(total(half, most).count());
    constexpr double tolerance = 0.004;
    return std::abs(late - early) <= tolerance * early;
}

bool speed_is_met(double measured_hz, double wanted_hz) {
    constexpr double tolerance = 0.02;
    return measured_hz > 0 && wanted_hz > 0 &&
           std::abs(measured_hz - wanted_hz) <= tolerance * wanted_hz;
}

}  // namespace sweepcast::device
