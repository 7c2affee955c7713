// How many connections the system's limit on descriptors leaves room for.
#pragma once

#include <algorithm>
#include <cstddef>

namespace sweepcast::cli {

/// Raises this process's limit on open descriptors as far as it may be raised without privileges.
/// Returns the limit that holds then.
std::size_t raise_descriptor_limit();

/// The most connections for each of the two listeners when `descriptors` may be open: some are kept
/// for lidars, threads and the log, so that clients alone cannot use up all. At least one, at most
/// 10'000.
[[nodiscard]] constexpr std::size_t most_connections(std::size_t descriptors) {
    constexpr std::size_t kept = 64;
    constexpr std::size_t listeners = 2;
    const auto left = descriptors > kept ? (descriptors - kept) / listeners : 0;
    return std::clamp<std::size_t>(left, 1, 10'000);
}

}  // namespace sweepcast::cli
