// Sweeps of a virtual lidar, in made-up time: what the driver would give of it, and what the line
// carried.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "driver/protocol/answer_type.hpp"
#include "driver/virtual/world.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace sweepcast::test {

/// A virtual lidar in one of its modes.
struct VirtualScanner {
    std::string_view model;
    protocol::AnswerType type{};
};

/// One for each answer type.
inline constexpr std::array one_of_each_type{
    VirtualScanner{"a1m8", protocol::AnswerType::normal},
    VirtualScanner{"a1m8", protocol::AnswerType::express},
    VirtualScanner{"s3", protocol::AnswerType::hq},
    VirtualScanner{"a3m1", protocol::AnswerType::ultra},
    VirtualScanner{"s2", protocol::AnswerType::dense},
    VirtualScanner{"c1", protocol::AnswerType::ultra_dense},
};

struct VirtualSweeps {
    std::vector<device::CapturedSweep> sweeps;
    /// Of the answer type, on average, packets' heads included.
    double line_bytes_per_sample{};
};

/// The first `count` whole sweeps of a model that there is, in its first mode of an answer type
/// that it has, in that world. The same for the same arguments.
[[nodiscard]] VirtualSweeps virtual_sweeps(
    const VirtualScanner& scanner,
    std::shared_ptr<const virtual_lidar::World> world,
    std::size_t count,
    std::uint64_t seed = 1
);

}  // namespace sweepcast::test
