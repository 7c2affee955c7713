// LineQuality: what came over the line since the port was opened, and how much of it was damaged.
#pragma once

#include <cstdint>
#include <string>

namespace sweepcast::device {

struct LineQuality {
    std::uint32_t baud{};  ///< bits per second; 0: a network
    std::uint64_t bytes{};
    std::uint64_t samples{};
    std::uint64_t checksum_errors{};
    std::uint64_t skipped_bytes{};
    std::uint64_t lost_packets{};
    /// What is wrong with it of late and what to do about it, if it is degraded.
    std::string warning{};
    bool operator==(const LineQuality&) const = default;
};

}  // namespace sweepcast::device
