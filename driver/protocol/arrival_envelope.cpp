// The lower convex hull of arrival times, and when the line has to be given up for another one.
#include "driver/protocol/arrival_envelope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace sweepcast::protocol {
namespace {

/// Of which the earliest point is kept: several bursts of a USB adapter.
constexpr double bucket_length = 62.5e6;
/// How far the true rate may well be from the one that the lidar tells.
constexpr double rate_doubt = 0.003;
/// So many buckets in a row far above the line are a new line.
constexpr std::size_t shifted_buckets = 3;
constexpr double shifted_by_unrest = 4.0;
constexpr double least_shift = 200e3;
constexpr std::size_t fewest_buckets = 8;

double median(std::span<double> values) {
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

ArrivalEnvelope::ArrivalEnvelope(double nominal_step)
    : nominal_step_(nominal_step)
    , line_{0.0, nominal_step} {}

void ArrivalEnvelope::add(double count, double time, double least_scatter) {
    least_scatter_ = least_scatter;
    if (size_ == 0 || time >= bucket_ends_) {
        close_bucket();
        bucket_ends_ = time + bucket_length;
        points_[size_++] = {count, time};
        fit();
        return;
    }
    auto& lowest = points_[size_ - 1];
    if (above(count, time) < above(lowest.count, lowest.time)) {
        lowest = {count, time};
    }
    if (above(count, time) < 0.0) {
        fit();
    }
}

void ArrivalEnvelope::shift(double by) {
    for (std::size_t i = 0; i < size_; ++i) {
        points_[i].time += by;
    }
    line_.offset += by;
}

/// Judges the bucket that is complete, and makes room for another.
void ArrivalEnvelope::close_bucket() {
    if (size_ > shifted_buckets) {
        double least = std::numeric_limits<double>::max();
        for (std::size_t i = size_ - shifted_buckets; i < size_; ++i) {
            least = std::min(least, distance(i));
        }
        if (least > least_scatter_ + shifted_by_unrest * unrest_ + least_shift) {
            for (std::size_t i = 0; i < size_ - shifted_buckets; ++i) {
                points_[i].time += least;
            }
        }
    }
    forget_misfits();
    if (size_ == most_buckets) {
        std::shift_left(points_.begin(), points_.end(), 1);
        --size_;
    }
}

/// Where the points do not lie along a line, only the latest count: samples get lost unnoticed.
void ArrivalEnvelope::forget_misfits() {
    if (size_ > fewest_buckets &&
        scatter_ > least_scatter_ + shifted_by_unrest * unrest_ + least_shift) {
        std::shift_left(points_.begin(), points_.end(), static_cast<std::ptrdiff_t>(size_ / 2));
        size_ -= size_ / 2;
    }
}

void ArrivalEnvelope::fit() {
    line_.step = nominal_step_;
    if (settled()) {
        const auto span = points_[size_ - 1].time - points_[0].time;
        const auto doubtful = std::max(scatter_, least_scatter_) / rate_doubt;
        const auto trust =
            nominal_step_ > 0.0 ? span * span / (span * span + doubtful * doubtful) : 1.0;
        line_.step += trust * (hull_step() - nominal_step_);
    }
    line_.offset = 0.0;
    auto lowest = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < size_; ++i) {
        lowest = std::min(lowest, distance(i));
    }
    line_.offset = lowest;
    measure_scatter();
}

/// The slope of the hull's edge over the mean count.
double ArrivalEnvelope::hull_step() const {
    std::array<Point, most_buckets> hull{};
    std::size_t corners = 0;
    double sum = 0.0;
    for (std::size_t i = 0; i < size_; ++i) {
        const auto& point = points_[i];
        sum += point.count;
        const auto above_edge = [&] {
            const auto& a = hull[corners - 2];
            const auto& b = hull[corners - 1];
            return (b.time - a.time) * (point.count - a.count) >=
                   (point.time - a.time) * (b.count - a.count);
        };
        while (corners >= 2 && above_edge()) {
            --corners;
        }
        hull[corners++] = point;
    }
    const auto mean = sum / static_cast<double>(size_);
    std::size_t right = 1;
    while (right + 1 < corners && hull[right].count < mean) {
        ++right;
    }
    const auto run = hull[right].count - hull[right - 1].count;
    const auto rise = hull[right].time - hull[right - 1].time;
    return run > 0.0 && rise >= 0.0 ? rise / run : nominal_step_;
}

void ArrivalEnvelope::measure_scatter() {
    if (!settled()) {
        return;
    }
    const auto complete = size_ - 1;
    std::array<double, most_buckets> distances{};
    std::array<double, most_buckets> changes{};
    for (std::size_t i = 0; i < complete; ++i) {
        distances[i] = distance(i);
        changes[i] = i == 0 ? 0.0 : std::abs(distances[i] - distances[i - 1]);
    }
    latest_above_ = distances[complete - 1];
    scatter_ = median(std::span(distances).first(complete));
    unrest_ = median(std::span(changes).first(complete));
}

double ArrivalEnvelope::distance(std::size_t point) const {
    return above(points_[point].count, points_[point].time);
}

}  // namespace sweepcast::protocol
