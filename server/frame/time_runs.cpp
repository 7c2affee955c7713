// A line fits if, over every two samples, its step lies between what the ends of their microseconds
// allow; of the samples before, only corners of two hulls can be the ones that allow the least.
#include "server/frame/time_runs.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>

namespace sweepcast::frame {

namespace {

using protocol::Sample;
using Samples = std::span<const Sample>;
/// Products of a position and a count of samples.
__extension__ using Wide = __int128;

struct Point {
    std::int64_t k{};   ///< number of the sample
    std::int64_t ps{};  ///< one end of its microsecond
};

std::int64_t round_down(std::int64_t value, std::int64_t by) {
    return value / by - (value % by < 0 ? 1 : 0);
}

std::int64_t round_up(std::int64_t value, std::int64_t by) {
    return value / by + (value % by > 0 ? 1 : 0);
}

/// Twice the area of the triangle, negative if the way turns right.
Wide doubled_area(const Point& a, const Point& b, const Point& c) {
    return Wide{b.k - a.k} * (c.ps - a.ps) - Wide{b.ps - a.ps} * (c.k - a.k);
}

/// The line through the microseconds of samples in a row, as far as there is one.
class Line {
public:
    /// Whether the line can be led through this sample too, the next one; if so, it is.
    bool take(std::int64_t us) {
        const Point low{count_, us * ps_per_us};
        const Point high{count_, low.ps + ps_per_us - 1};
        std::int64_t least = least_;
        std::int64_t most = most_;
        for (const auto& before : lows_) {
            most = std::min(most, round_down(high.ps - before.ps, high.k - before.k));
        }
        for (const auto& before : highs_) {
            least = std::max(least, round_up(low.ps - before.ps, low.k - before.k));
        }
        if (least > most) {
            return false;
        }
        least_ = least;
        most_ = most;
        // Of the lower ends the upper hull, of the upper ends the lower one.
        while (lows_.size() > 1 && doubled_area(lows_[lows_.size() - 2], lows_.back(), low) >= 0) {
            lows_.pop_back();
        }
        lows_.push_back(low);
        while (highs_.size() > 1 &&
               doubled_area(highs_[highs_.size() - 2], highs_.back(), high) <= 0) {
            highs_.pop_back();
        }
        highs_.push_back(high);
        ++count_;
        return true;
    }

    [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(count_); }

    [[nodiscard]] std::int64_t step() const {
        return count_ < 2 ? 0 : least_ + (most_ - least_) / 2;
    }

    /// Where the line is at its first sample.
    [[nodiscard]] std::int64_t start() const {
        std::int64_t least = std::numeric_limits<std::int64_t>::min();
        std::int64_t most = std::numeric_limits<std::int64_t>::max();
        for (const auto& low : lows_) {
            least = std::max(least, low.ps - step() * low.k);
        }
        for (const auto& high : highs_) {
            most = std::min(most, high.ps - step() * high.k);
        }
        return least + (most - least) / 2;
    }

    void clear() {
        count_ = 0;
        least_ = std::numeric_limits<std::int64_t>::min();
        most_ = std::numeric_limits<std::int64_t>::max();
        lows_.clear();
        highs_.clear();
    }

private:
    std::int64_t count_{};
    std::int64_t least_{std::numeric_limits<std::int64_t>::min()};  ///< step
    std::int64_t most_{std::numeric_limits<std::int64_t>::max()};
    std::vector<Point> lows_;
    std::vector<Point> highs_;
};

/// Microseconds since `begin`.
std::int64_t since(protocol::SampleTime begin, protocol::SampleTime time) {
    std::int64_t us = 0;
    const bool overflows = __builtin_sub_overflow(
        time.time_since_epoch().count(),
        begin.time_since_epoch().count(),
        &us
    );
    if (overflows) {
        return time < begin ? -farthest_us : farthest_us;
    }
    return std::clamp(us, -farthest_us, farthest_us);
}

void append(const Line& line, std::int64_t& position, std::vector<TimeRun>& runs) {
    if (line.count() == 0) {
        return;
    }
    runs.push_back({1, line.start() - position});
    if (line.count() > 1) {
        runs.push_back({line.count() - 1, line.step()});
    }
    position = line.start() + line.step() * (line.count() - 1);
}

}  // namespace

void to_time_runs(Samples samples, protocol::SampleTime begin, std::vector<TimeRun>& runs) {
    runs.clear();
    Line line;
    std::int64_t position = 0;
    for (const auto& sample : samples) {
        const auto us = since(begin, sample.time);
        if (!line.take(us)) {
            append(line, position, runs);
            line.clear();
            (void)line.take(us);  // a line of one sample always fits
        }
    }
    append(line, position, runs);
}

}  // namespace sweepcast::frame
