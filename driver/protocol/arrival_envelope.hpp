// ArrivalEnvelope: the straight line under arrival times that are late by more or less.
#pragma once

#include <array>
#include <cstddef>

namespace sweepcast::protocol {

/// A moment as a function of how many samples had been taken, in nanoseconds.
struct SampleLine {
    double offset{};
    double step{};  ///< from one sample to the next
    [[nodiscard]] double at(double count) const { return offset + step * count; }
};

/// Samples are taken at a steady rate, and their packets can only be late: so the line that lies
/// under all points (count, arrival) and as close to them as possible tells when they would have
/// arrived without delay. Of each short stretch of time the earliest point is kept, some seconds of
/// them; the line is the edge of their lower convex hull over the mean count, which of all lines
/// under them has the least distances from them (Moon, Skelly and Towsley 1999). While they cover
/// too short a time for how much they scatter, its slope is drawn towards the one that the lidar
/// tells.
class ArrivalEnvelope {
public:
    /// `nominal_step`: from one sample to the next as the lidar tells it, in nanoseconds; 0: it
    /// does not.
    explicit ArrivalEnvelope(double nominal_step);

    /// Takes a point. `least_scatter` is how late every point may be without that being seen.
    void add(double count, double time, double least_scatter);

    /// Moves what was taken so far: samples were lost, or a pause came after it.
    void shift(double by);

    /// How far a moment lies above the line; negative: below.
    [[nodiscard]] double above(double count, double time) const { return time - line_.at(count); }

    [[nodiscard]] const SampleLine& line() const { return line_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    /// Whether the line has been seen for long enough to know how late things are.
    [[nodiscard]] bool settled() const { return size_ > settling_buckets; }
    /// Whether what it has seen is enough to judge the scatter by.
    [[nodiscard]] bool experienced() const { return size_ >= experience_buckets; }
    /// How far the earliest points of stretches typically lie above the line.
    [[nodiscard]] double scatter() const { return scatter_; }
    /// How far the latest complete stretch lies above it.
    [[nodiscard]] double latest_above() const { return latest_above_; }

private:
    struct Point {
        double count{};
        double time{};
    };
    static constexpr std::size_t most_buckets = 64;
    static constexpr std::size_t settling_buckets = 3;
    static constexpr std::size_t experience_buckets = 16;

    void close_bucket();
    void fit();
    [[nodiscard]] double hull_step() const;
    void measure_scatter();
    void forget_misfits();
    [[nodiscard]] double distance(std::size_t point) const;

    double nominal_step_;
    SampleLine line_;
    std::array<Point, most_buckets> points_{};  ///< of each bucket the lowest, the last one is open
    std::size_t size_{};
    double bucket_ends_{};
    double scatter_{};
    double unrest_{};  ///< how much the distance changes from one point to the next, typically
    double least_scatter_{};
    double latest_above_{};
};

}  // namespace sweepcast::protocol
