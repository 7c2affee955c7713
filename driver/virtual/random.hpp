// Random: the same seed gives the same numbers with every compiler and library, so that a run can
// be repeated.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace sweepcast::virtual_lidar {

/// SplitMix64 (Steele, Lea, Flood 2014). The standard library's distributions are not used because
/// their output is not specified.
class Random {
public:
    explicit constexpr Random(std::uint64_t seed) : state_(seed) {}

    /// 64 random bits.
    constexpr std::uint64_t next() {
        state_ += 0x9E3779B97F4A7C15U;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
        z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
        return z ^ (z >> 31U);
    }

    /// Uniform in [0, 1).
    double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }

    /// Normal, mean 0, standard deviation 1 (Box and Muller).
    double gaussian() {
        const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));  // 1 - u is never 0
        return radius * std::cos(2.0 * std::numbers::pi * uniform());
    }

private:
    std::uint64_t state_;
};

}  // namespace sweepcast::virtual_lidar
