// Time errors: how far the times of samples are from the truth that a LineScan knows.
#pragma once

#include "driver/protocol/sweep.hpp"
#include "tests/support/line_model.hpp"

#include <cstddef>
#include <vector>

namespace sweepcast::test {

/// The sweeps of a scan, with times reckoned back from the arrival of each packet (protocol.md 8).
[[nodiscard]] std::vector<protocol::Sweep>
reckoned_back(const LineScan& scan, protocol::AnswerType type);

/// The sweeps of a scan as a ScanReader gives them.
[[nodiscard]] std::vector<protocol::Sweep> as_read(const LineScan& scan, protocol::AnswerType type);

struct TimeErrors {
    double median_us{};
    double p99_us{};
    double greatest_us{};
    std::size_t back{};  ///< samples not later than the one before
    double stated_us{};  ///< the uncertainty that sweeps tell, median
    double within{};     ///< part of the sweeps all of whose errors are within it
};

/// Of the samples whose angle goes on from the one before: of others it tells no time.
[[nodiscard]] TimeErrors
time_errors(const LineScan& scan, const std::vector<protocol::Sweep>& sweeps);

}  // namespace sweepcast::test
