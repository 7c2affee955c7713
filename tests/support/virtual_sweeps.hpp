// Sweeps of a virtual lidar, in made-up time: what the driver would give of it, and what the line
// carried.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "driver/protocol/answer_type.hpp"
#include "driver/virtual/world.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace sweepcast::test {

struct VirtualSweeps {
    std::vector<device::CapturedSweep> sweeps;
    /// Of the answer type, on average, packets' heads included.
    double line_bytes_per_sample{};
};

/// The first `count` whole sweeps of the model `key` (which there is), in its first mode of that
/// answer type (which it has), in that world. The same for the same arguments.
[[nodiscard]] VirtualSweeps virtual_sweeps(
    std::string_view key,
    protocol::AnswerType type,
    std::shared_ptr<const virtual_lidar::World> world,
    std::size_t count,
    std::uint64_t seed = 1
);

}  // namespace sweepcast::test
