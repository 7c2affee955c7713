// Beam: one distance measurement, with the noise, the dropouts and the limits of a real one.
#pragma once

#include "driver/virtual/persona.hpp"
#include "driver/virtual/random.hpp"
#include "driver/virtual/world.hpp"

#include <cstdint>
#include <memory>
#include <optional>

namespace sweepcast::virtual_lidar {

/// How measurements deviate from the world.
struct BeamSettings {
    /// Standard deviation of every distance in millimetres, 0 for none; unset: the persona's.
    std::optional<double> noise_mm{};
    /// The part of measurements that bring no echo though there is a wall, 0..1.
    double dropout{};
    /// Same seed and same calls, same measurements.
    std::uint64_t seed{};
};

/// A measurement. Without an echo both are 0.
struct Echo {
    double distance_mm{};
    std::uint8_t quality6{};  ///< 0..63, falling with the distance
};

class Beam {
public:
    Beam(
        std::shared_ptr<const World> world,
        const BeamTraits& traits,
        const BeamSettings& settings
    );

    /// Measures at `angle_deg` (clockwise, any value) and time `t`. Distances come as they are: the
    /// caller rounds to the unit of its answer type.
    Echo measure(double angle_deg, Seconds t);

    /// What is truly there, within the limits of the scanner: no noise, no dropouts.
    [[nodiscard]] std::optional<double> true_distance_mm(double angle_deg, Seconds t) const;

private:
    std::shared_ptr<const World> world_;
    BeamTraits traits_;
    BeamSettings settings_;
    Random random_;
};

}  // namespace sweepcast::virtual_lidar
