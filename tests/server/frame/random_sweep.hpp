// Sweeps for tests: of every shape that samples can take, and such as a real scanner gives.
#pragma once

#include "driver/device/captured_sweep.hpp"

#include <cstdint>
#include <random>

namespace sweepcast::frame {

/// A sweep of up to a few hundred samples whose columns are, each by chance, constant, smooth, wild
/// or at their limits.
device::CapturedSweep random_sweep(std::mt19937_64& random);

/// How a scanner measures.
struct ScannerShape {
    std::size_t samples{};              ///< a turn
    std::uint32_t distance_step_q2{4};  ///< quarter millimetres
    bool measures_quality{};
    protocol::AnswerType answer_type{protocol::AnswerType::express};
};

/// A turn in a rectangular room with pillars: 1.5 mm of noise, 4 % of the samples without an echo,
/// angles in 1/64 degrees corrected per sample, times on a line.
device::CapturedSweep sweep_of_a_room(const ScannerShape& shape, std::mt19937_64& random);

}  // namespace sweepcast::frame
