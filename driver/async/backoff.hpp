// How long to wait before the next attempt at something that others may attempt, too.
#pragma once

#include <chrono>
#include <cstdint>

namespace sweepcast::async {

/// Each wait is twice the one before, up to `longest`.
struct Backoff {
    std::chrono::milliseconds first{250};
    std::chrono::milliseconds longest{10'000};
};

/// The wait after `failures` attempts in a row that failed (from 1). `luck`, from 0 to 1, draws it
/// from the upper half of what the schedule has, so that all those who wait
/// for the same thing do not come at once.
[[nodiscard]] std::chrono::milliseconds
wait_after(std::uint32_t failures, const Backoff& backoff, double luck);

}  // namespace sweepcast::async
