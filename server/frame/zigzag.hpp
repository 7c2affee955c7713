// Zigzag: signed numbers as unsigned ones, small for small magnitudes.
#pragma once

#include <cstdint>

namespace sweepcast::frame {

/// 0, -1, 1, -2 ... -> 0, 1, 2, 3 ...
constexpr std::uint64_t zigzag(std::int64_t value) {
    return (static_cast<std::uint64_t>(value) << 1U) ^ (value < 0 ? ~std::uint64_t{0} : 0);
}

/// The inverse of zigzag(), of every value.
constexpr std::int64_t unzigzag(std::uint64_t value) {
    return static_cast<std::int64_t>((value >> 1U) ^ (0 - (value & 1U)));
}

static_assert(
    zigzag(0) == 0 && zigzag(-1) == 1 && zigzag(1) == 2 && zigzag(INT64_MIN) == UINT64_MAX
);
static_assert(
    unzigzag(1) == -1 && unzigzag(UINT64_MAX) == INT64_MIN && unzigzag(UINT64_MAX - 1) == INT64_MAX
);

}  // namespace sweepcast::frame
