// Angles that rise evenly within each packet, as the few numbers that the lidar sent of them.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/sample.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sweepcast::frame {

/// A sample whose angle is not what its ramp makes of it.
struct AngleFix {
    std::uint32_t index{};
    std::int32_t add{};  ///< 1/64 degrees
};

/// As the message of the same name (proto/sweepcast/v1/scan.proto), without its differences.
struct AngleRamps {
    std::uint32_t length{};  ///< samples of a ramp
    std::uint32_t skip{};    ///< samples of the first ramp that are not there
    /// Where each ramp starts and the last one ends, in 1/64 degrees, not wrapped.
    std::vector<std::int32_t> starts;
    bool parallax{};
    std::vector<std::int32_t> corrections;  ///< of each sample in 1/8 degree; empty: none
    std::vector<AngleFix> fixes;            ///< by index
};

/// The ramps on which the angles of `samples` lie, all of which are of 1/64 degrees (is_q6). None
/// if answers of that type have an angle for each sample, or if too many do not lie on any, as
/// after some were taken out.
[[nodiscard]] std::optional<AngleRamps>
fit_ramps(std::span<const protocol::Sample> samples, protocol::AnswerType type);

/// Sets the angle of each sample, whose distance is known. `ramps` has starts for all of them, as
/// many corrections as samples or none, and fixes of samples that are there.
void apply_ramps(const AngleRamps& ramps, std::span<protocol::Sample> samples);

}  // namespace sweepcast::frame
