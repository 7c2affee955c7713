// Samples -> columns, one function a column.
#include "server/frame/angle_units.hpp"
#include "server/frame/printable.hpp"
#include "server/frame/scan_columns.hpp"
#include "server/frame/zigzag.hpp"
#include "sweepcast/v1/scan.pb.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <stdexcept>

namespace sweepcast::frame {

namespace {

using protocol::Sample;
using Samples = std::span<const Sample>;

void write_angles(Samples samples, v1::Scan& scan) {
    const bool q6 =
        std::all_of(samples.begin(), samples.end(), [](const Sample& s) { return is_q6(s.angle); });
    const auto turn = static_cast<std::int32_t>(q6 ? q6_per_turn : q14_per_turn);
    scan.set_angle_units_per_turn(static_cast<std::uint32_t>(turn));
    auto& column = *scan.mutable_angle();
    column.Reserve(static_cast<int>(samples.size()));
    bool first = true;
    std::int32_t before = 0;
    for (const auto& sample : samples) {
        const auto angle = static_cast<std::int32_t>(q6 ? to_q6(sample.angle) : sample.angle.raw);
        std::int32_t step = angle - before;
        if (!first) {  // the short way around
            step -= step > turn / 2 ? turn : 0;
            step += step < -turn / 2 ? turn : 0;
        }
        column.AddAlreadyReserved(step);
        before = angle;
        first = false;
    }
}

void write_distances(Samples samples, v1::Scan& scan) {
    // Most modes measure whole millimetres, four of the vendor's units.
    const bool millimetres = std::all_of(samples.begin(), samples.end(), [](const Sample& s) {
        return s.distance.raw % 4 == 0;
    });
    scan.set_distance_unit_um(millimetres ? 1000 : 250);
    const unsigned shift = millimetres ? 2 : 0;
    auto& column = *scan.mutable_distance();
    column.Reserve(static_cast<int>(samples.size()));
    std::int64_t before = 0;
    for (const auto& sample : samples) {
        if (!sample.distance.has_echo()) {
            column.AddAlreadyReserved(0);
            continue;
        }
        const std::int64_t distance = sample.distance.raw >> shift;
        column.AddAlreadyReserved(zigzag(distance - before) + 1);
        before = distance;
    }
}

void write_qualities(Samples samples, v1::Scan& scan) {
    const auto echo = std::find_if(samples.begin(), samples.end(), [](const Sample& s) {
        return s.distance.has_echo();
    });
    const std::uint8_t usual = echo == samples.end() ? std::uint8_t{0} : echo->quality;
    const bool is_constant = std::all_of(samples.begin(), samples.end(), [usual](const Sample& s) {
        return s.quality == (s.distance.has_echo() ? usual : 0);
    });
    if (is_constant) {
        scan.set_echo_quality(usual);
        return;
    }
    auto& column = *scan.mutable_quality();
    column.resize(samples.size());
    std::transform(samples.begin(), samples.end(), column.begin(), [](const Sample& s) {
        return static_cast<char>(s.quality);
    });
}

std::uint8_t most_common_flag(Samples samples) {
    std::array<std::uint32_t, 256> counts{};
    for (const auto& sample : samples) {
        ++counts[sample.flag];
    }
    return static_cast<std::uint8_t>(
        std::max_element(counts.begin(), counts.end()) - counts.begin()
    );
}

void write_flags(Samples samples, v1::Scan& scan) {
    const std::uint8_t usual = most_common_flag(samples);
    scan.set_flag(usual);
    std::uint32_t before = 0;
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        if (samples[i].flag != usual) {
            scan.add_flag_index(i - before);
            scan.mutable_flag_value()->push_back(static_cast<char>(samples[i].flag));
            before = i;
        }
    }
}

/// From sample i-1 to sample i in microseconds, modulo 2^64, so that every pair of times has one.
std::uint64_t time_step(Samples samples, std::size_t i) {
    return static_cast<std::uint64_t>(samples[i].time.time_since_epoch().count()) -
           static_cast<std::uint64_t>(samples[i - 1].time.time_since_epoch().count());
}

std::size_t count_steps(Samples samples, std::uint64_t step) {
    std::size_t count = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
        count += time_step(samples, i) == step ? 1U : 0U;
    }
    return count;
}

/// The step that most samples take: the majority if there is one, else what the lidar reports. The
/// clock of the lidar and of its report need not agree to the microsecond.
std::uint32_t usual_step(Samples samples, std::chrono::microseconds reported) {
    constexpr std::int64_t longest = std::numeric_limits<std::uint32_t>::max();
    const auto reported_step =
        static_cast<std::uint32_t>(std::clamp<std::int64_t>(reported.count(), 0, longest));
    std::uint64_t candidate = reported_step;  // majority vote after Boyer and Moore
    std::size_t lead = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
        const std::uint64_t step = time_step(samples, i);
        if (lead == 0) {
            candidate = step;
        }
        lead = step == candidate ? lead + 1 : lead - 1;
    }
    if (candidate > static_cast<std::uint64_t>(longest) ||
        count_steps(samples, candidate) <= count_steps(samples, reported_step)) {
        return reported_step;
    }
    return static_cast<std::uint32_t>(candidate);
}

void write_times(Samples samples, std::chrono::microseconds reported, v1::Scan& scan) {
    const std::uint32_t period = usual_step(samples, reported);
    scan.set_sample_period_us(period);
    if (samples.size() < 2 || count_steps(samples, period) == samples.size() - 1) {
        return;
    }
    auto& column = *scan.mutable_time_residual();
    column.Reserve(static_cast<int>(samples.size() - 1));
    for (std::size_t i = 1; i < samples.size(); ++i) {
        column.AddAlreadyReserved(static_cast<std::int64_t>(time_step(samples, i) - period));
    }
}

std::uint64_t unix_ns(protocol::SampleTime time, std::chrono::nanoseconds monotonic_to_unix) {
    std::int64_t ns = 0;
    const bool overflows =
        __builtin_mul_overflow(time.time_since_epoch().count(), std::int64_t{1000}, &ns) ||
        __builtin_add_overflow(ns, std::int64_t{monotonic_to_unix.count()}, &ns);
    return overflows || ns < 0 ? 0 : static_cast<std::uint64_t>(ns);
}

}  // namespace

void to_columns(const device::CapturedSweep& captured, v1::Scan& scan) {
    const Samples samples = captured.sweep.samples;
    if (samples.size() > max_samples) {
        throw std::length_error("a sweep of more samples than a scan can carry");
    }
    scan.Clear();
    write_angles(samples, scan);
    write_distances(samples, scan);
    write_qualities(samples, scan);
    write_flags(samples, scan);
    write_times(samples, captured.sample_duration, scan);
    if (!samples.empty()) {
        const auto first = samples.front().time;
        scan.set_first_unix_ns(unix_ns(first, captured.monotonic_to_unix));
        scan.set_first_monotonic_us(static_cast<std::uint64_t>(first.time_since_epoch().count()));
    }
    constexpr std::int64_t longest = std::numeric_limits<std::uint32_t>::max();
    scan.set_period_us(static_cast<std::uint32_t>(
        std::clamp<std::int64_t>(captured.sweep.period.count(), 0, longest)
    ));
    scan.set_mode(printable(captured.mode));
    scan.set_answer_type(static_cast<std::uint32_t>(captured.answer_type));
    scan.set_checksum_errors(captured.sweep.losses.checksum_errors);
    scan.set_skipped_bytes(captured.sweep.losses.skipped_bytes);
    scan.set_discarded_samples(captured.sweep.losses.discarded_samples);
    scan.set_lost_packets(captured.sweep.losses.lost_packets);
}

}  // namespace sweepcast::frame
