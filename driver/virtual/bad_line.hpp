// BadLine: a line that changes, loses and doubles bytes.
#pragma once

#include "driver/virtual/random.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sweepcast::virtual_lidar {

/// How bad a line is: parts of the bytes, 0..1.
struct LineQuality {
    double noise{};      ///< changed
    double drop{};       ///< lost
    double duplicate{};  ///< arriving twice
};

class BadLine {
public:
    /// Same seed, same bytes and same calls, same damage.
    BadLine(const LineQuality& quality, std::uint64_t seed) : quality_(quality), random_(seed) {}

    void set_quality(const LineQuality& quality) { quality_ = quality; }

    /// Loses the next `count` bytes, whatever the quality.
    void lose_next(std::size_t count) { to_lose_ = count; }

    /// Whether every byte arrives as it was sent.
    [[nodiscard]] bool is_good() const;

    /// Appends to `arrived` what arrives of `byte`: nothing, the byte, another one, or it twice.
    void pass(std::uint8_t byte, std::vector<std::uint8_t>& arrived);

    /// Appends to `arrived` another byte than `byte`.
    void change(std::uint8_t byte, std::vector<std::uint8_t>& arrived);

private:
    LineQuality quality_;
    Random random_;
    std::size_t to_lose_{};
};

}  // namespace sweepcast::virtual_lidar
