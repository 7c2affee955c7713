// LineWatch: says when a line damages so much of what it carries that somebody should see to it.
#pragma once

#include "driver/device/line_quality.hpp"

#include <chrono>
#include <cstddef>
#include <deque>
#include <string>

namespace sweepcast::device {

/// Looks at the last `window`. A lidar is never reset for it: its samples are still good, there are
/// only fewer of them.
class LineWatch {
public:
    static constexpr std::chrono::milliseconds window{5000};
    /// Parts of the samples lost: above the first the line is degraded, below the second no more.
    static constexpr double worst = 0.01;
    static constexpr double fine = 0.002;
    /// Fewer damages than this within the window are no evidence.
    static constexpr std::uint64_t least_damages = 5;

    /// Takes the totals of the line at that time, of a scan whose packets have so many samples.
    void take(
        const LineQuality& line,
        std::size_t samples_per_packet,
        std::chrono::steady_clock::time_point now
    );

    /// What is wrong and what to do, as long as the line is degraded; else empty. How bad it is is
    /// told in steps, the worst so far, so that it is not news over and over.
    [[nodiscard]] const std::string& warning() const { return warning_; }

    /// Forgets what it saw: another line, or another scan.
    void restart();

private:
    struct Totals {
        std::chrono::steady_clock::time_point at{};
        std::uint64_t samples{};
        std::uint64_t damages{};
        std::uint64_t lost_samples{};
    };

    void warn(double share);

    std::deque<Totals> seen_;
    double told_{};  ///< the step that the warning tells
    std::string warning_;
};

}  // namespace sweepcast::device
