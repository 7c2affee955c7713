#include "driver/device/line_watch.hpp"

#include <fmt/format.h>

namespace sweepcast::device {

using namespace std::chrono_literals;

void LineWatch::take(
    const LineQuality& line,
    std::size_t samples_per_packet,
    std::chrono::steady_clock::time_point now
) {
    constexpr auto step = window / 10;
    if (!seen_.empty() && now - seen_.back().at < step) {
        return;
    }
    const auto packets = line.checksum_errors + line.lost_packets;
    seen_.push_back({now, line.samples, packets, packets * samples_per_packet});
    while (now - seen_.front().at > window) {
        seen_.pop_front();
    }
    const auto& first = seen_.front();
    const auto damages = packets - first.damages;
    const auto lost = static_cast<double>(seen_.back().lost_samples - first.lost_samples);
    const auto came = static_cast<double>(line.samples - first.samples);
    const double share = lost > 0 ? lost / (lost + came) : 0;
    if (share > worst && damages >= least_damages) {
        warn(share);
    } else if (share < fine && now - first.at > window - 2 * step) {
        warning_.clear();
        told_ = 0;
    }
}

void LineWatch::warn(double share) {
    for (const double step : {worst, 0.03, 0.1, 0.3}) {
        if (share > step && step > told_) {
            told_ = step;
        }
    }
    warning_ = fmt::format(
        "the line loses more than {:.0f} % of the samples: check cable, plug, power and what runs "
        "beside them; a USB hub or a long cable may be too much for it",
        told_ * 100.0
    );
}

void LineWatch::restart() {
    seen_.clear();
    warning_.clear();
    told_ = 0;
}

}  // namespace sweepcast::device
