#include "driver/async/backoff.hpp"

#include <algorithm>

namespace sweepcast::async {

std::chrono::milliseconds wait_after(std::uint32_t failures, const Backoff& backoff, double luck) {
    constexpr std::uint32_t most_doublings = 20;  // a quarter of a second becomes three days
    const auto doublings = std::min(std::max(failures, 1U) - 1, most_doublings);
    const auto longest = std::max(backoff.longest, std::chrono::milliseconds(1));
    const auto full = std::clamp(
        backoff.first * (std::int64_t{1} << doublings),
        std::chrono::milliseconds(1),
        longest
    );
    const double share = 0.5 + 0.5 * std::clamp(luck, 0.0, 1.0);
    return std::chrono::milliseconds(std::max<std::int64_t>(
        static_cast<std::int64_t>(static_cast<double>(full.count()) * share),
        1
    ));
}

}  // namespace sweepcast::async
