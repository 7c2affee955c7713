// Life: where a lidar is in its life and what led there, as a value that others can keep and show.
#pragma once

#include "driver/device/phase.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sweepcast::device {

/// A change of phase, for people to read.
struct PhaseChange {
    Phase from{};
    Phase to{};
    std::chrono::system_clock::time_point at{};
    std::string cause;  ///< empty: it needs none
    bool operator==(const PhaseChange&) const = default;
};

/// How many changes are kept.
inline constexpr std::size_t recent_changes = 12;

struct Life {
    Phase phase{Phase::disconnected};
    std::chrono::system_clock::time_point since{};
    /// Why it is in this phase, if that needs saying, and what to do about it. While it is tried
    /// again: why it has to be.
    std::string cause;
    std::string hint;
    /// When it is tried again, while backing off.
    std::optional<std::chrono::system_clock::time_point> next_attempt;
    /// Since when it has neither scanned nor been ready, through all attempts; unset if it is well.
    std::optional<std::chrono::system_clock::time_point> failing_since;
    /// Times that it came back from that by itself.
    std::uint32_t recoveries{};
    /// Changes of phase so far; the last of them, oldest first.
    std::uint64_t changes{};
    std::vector<PhaseChange> recent;
};

}  // namespace sweepcast::device
