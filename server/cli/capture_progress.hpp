// CaptureProgress: what `sweepcast capture` says of itself, on standard error.
#pragma once

#include "driver/capture/capture_header.hpp"
#include "driver/device/line_quality.hpp"

#include <chrono>
#include <cstdint>
#include <string>

namespace sweepcast::cli {

/// What a capture holds so far.
struct CaptureTotals {
    std::chrono::duration<double> length{};  ///< since the first samples
    std::uint64_t bytes{};                   ///< from the lidar
    std::uint64_t sweeps{};
    device::LineQuality line{};
};

/// E.g. "10.0 s, 83121 bytes, 55 sweeps, 0 checksum errors, 0 bytes skipped, 0 packets lost".
[[nodiscard]] std::string to_text(const CaptureTotals& totals);

/// A line when a capture begins, one that is rewritten in place if standard error is a terminal,
/// and a last one.
class CaptureProgress {
public:
    void begin(const capture::CaptureHeader& header, const std::string& path) const;
    void update(const CaptureTotals& totals);
    /// Leaves the line that was rewritten to what is printed next.
    void clear();
    void end(const CaptureTotals& totals, const std::string& path);

private:
    std::chrono::steady_clock::time_point printed_at_{};
    bool shown_{};
};

}  // namespace sweepcast::cli
