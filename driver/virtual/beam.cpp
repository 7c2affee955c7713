#include "driver/virtual/beam.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sweepcast::virtual_lidar {

Beam::Beam(
    std::shared_ptr<const World> world,
    const BeamTraits& traits,
    const BeamSettings& settings
)
    : world_(std::move(world))
    , traits_(traits)
    , settings_(settings)
    , random_(settings.seed) {}

Echo Beam::measure(double angle_deg, Seconds t) {
    const auto truth = true_distance_mm(angle_deg, t);
    if (!truth || random_.uniform() < settings_.dropout) {
        return {};
    }
    const double sigma_mm =
        settings_.noise_mm.value_or(std::max(traits_.noise_floor_mm, traits_.noise_part * *truth));
    const double noisy_mm = *truth + sigma_mm * random_.gaussian();
    const double distance_mm =
        std::clamp(noisy_mm, traits_.min_distance_mm, traits_.max_distance_mm);
    // 60 close by, 10 at the end of the range: enough to see the difference in a picture.
    const double quality = 60.0 - 50.0 * distance_mm / traits_.max_distance_mm;
    return {distance_mm, static_cast<std::uint8_t>(std::lround(quality))};
}

std::optional<double> Beam::true_distance_mm(double angle_deg, Seconds t) const {
    const auto distance_mm = world_->distance_mm(angle_deg, t);
    const bool in_range = distance_mm && *distance_mm >= traits_.min_distance_mm &&
                          *distance_mm <= traits_.max_distance_mm;
    return in_range ? distance_mm : std::nullopt;
}

}  // namespace sweepcast::virtual_lidar
