// Samples -> columns, one function a column.
#include "driver/protocol/printable.hpp"
#include "server/frame/angle_ramps.hpp"
#include "server/frame/angle_units.hpp"
#include "server/frame/distance_units.hpp"
#include "server/frame/scan_columns.hpp"
#include "server/frame/time_runs.hpp"
#include "server/frame/zigzag.hpp"
#include "sweepcast/v1/scan.pb.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace sweepcast::frame {

namespace {

using protocol::Sample;
using Samples = std::span<const Sample>;

std::uint32_t to_uint32(std::int64_t value) {
    constexpr std::int64_t most = std::numeric_limits<std::uint32_t>::max();
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(value, 0, most));
}

/// Whether all angles are of 1/64 degrees.
bool all_q6(Samples samples) {
    return std::all_of(samples.begin(), samples.end(), [](const Sample& s) {
        return is_q6(s.angle);
    });
}

void write_ramps(const AngleRamps& ramps, v1::AngleRamps& message) {
    message.set_length(ramps.length);
    message.set_skip(ramps.skip);
    message.set_parallax(ramps.parallax);
    std::int32_t before = 0;
    for (const auto start : ramps.starts) {
        message.add_start(start - std::exchange(before, start));
    }
    before = 0;
    message.mutable_correction()->Reserve(static_cast<int>(ramps.corrections.size()));
    for (const auto correction : ramps.corrections) {
        message.add_correction(correction - std::exchange(before, correction));
    }
    std::uint32_t index_before = 0;
    for (const auto& fix : ramps.fixes) {
        message.add_fix_index(fix.index - std::exchange(index_before, fix.index));
        message.add_fix(fix.add);
    }
}

void write_differences(Samples samples, std::uint32_t per_turn, v1::Scan& scan) {
    const auto turn = static_cast<std::int32_t>(per_turn);
    auto& column = *scan.mutable_angle();
    column.Reserve(static_cast<int>(samples.size()));
    bool first = true;
    std::int32_t before = 0;
    for (const auto& sample : samples) {
        const auto angle = static_cast<std::int32_t>(to_units(sample.angle, per_turn));
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

void write_angles(const FrameContent& content, const FrameFormat& format, v1::Scan& scan) {
    const bool as_measured = format.angle_units_per_turn == 0;
    const bool q6 = as_measured && all_q6(content.samples);
    scan.set_angle_units_per_turn(
        as_measured ? (q6 ? q6_per_turn : q14_per_turn) : format.angle_units_per_turn
    );
    // Parallax is that of the distance, which the reader must then have as it was measured.
    const bool may_be_ramps = q6 && format.distance_unit_um == 0;
    if (const auto ramps =
            may_be_ramps ? fit_ramps(content.samples, content.answer_type) : std::nullopt) {
        write_ramps(*ramps, *scan.mutable_ramps());
    } else {
        write_differences(content.samples, scan.angle_units_per_turn(), scan);
    }
}

std::uint32_t distance_unit_um(Samples samples) {
    // Most modes measure whole millimetres, four of the vendor's units.
    const bool millimetres = std::all_of(samples.begin(), samples.end(), [](const Sample& s) {
        return s.distance.raw % 4 == 0;
    });
    return millimetres ? um_per_mm : um_per_q2;
}

void write_distances(Samples samples, std::uint32_t wanted_unit_um, v1::Scan& scan) {
    const std::uint32_t unit_um = wanted_unit_um > 0 ? wanted_unit_um : distance_unit_um(samples);
    scan.set_distance_unit_um(unit_um);
    auto& column = *scan.mutable_distance();
    column.Reserve(static_cast<int>(samples.size()));
    std::int64_t before = 0;
    for (const auto& sample : samples) {
        if (!sample.distance.has_echo()) {
            column.AddAlreadyReserved(0);
            continue;
        }
        const auto distance = static_cast<std::int64_t>(to_units(sample.distance, unit_um));
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

/// A time in nanoseconds, or the first or last there is.
std::int64_t to_ns(protocol::SampleTime time) {
    constexpr std::int64_t last_us = std::numeric_limits<std::int64_t>::max() / 1000;
    return std::clamp(time.time_since_epoch().count(), -last_us, last_us) * 1000;
}

std::uint64_t unix_ns(std::int64_t monotonic_ns, std::chrono::nanoseconds monotonic_to_unix) {
    std::int64_t ns = 0;
    const bool overflows =
        __builtin_add_overflow(monotonic_ns, std::int64_t{monotonic_to_unix.count()}, &ns);
    return overflows || ns < 0 ? 0 : static_cast<std::uint64_t>(ns);
}

void write_times(const FrameContent& content, bool left_out, v1::Scan& scan) {
    scan.set_sample_period_ns(to_uint32(content.sample_duration.count()));
    scan.set_time_uncertainty_us(to_uint32(content.time_uncertainty.count()));
    scan.set_wall_clock_step_ns(content.clock_step.count());
    scan.set_gap_ns(static_cast<std::uint64_t>(std::max<std::int64_t>(content.gap.count(), 0)));
    if (content.samples.empty()) {
        return;
    }
    // Of bins, which go by angle, any sample may be the earliest.
    const auto first = std::ranges::min_element(content.samples, {}, &Sample::time)->time;
    const std::int64_t first_ns = to_ns(first);
    scan.set_first_monotonic_ns(static_cast<std::uint64_t>(first_ns));
    scan.set_first_unix_ns(unix_ns(first_ns, content.monotonic_to_unix));
    if (left_out) {
        scan.add_left_out(v1::TIME);
    } else {
        std::vector<TimeRun> runs;
        to_time_runs(content.samples, first, runs);
        for (const auto& run : runs) {
            scan.add_time_run(run.count);
            scan.add_time_step_ps(run.step_ps);
        }
    }
}

}  // namespace

void to_columns(const FrameContent& content, const FrameFormat& format, v1::Scan& scan) {
    const Samples samples = content.samples;
    if (samples.size() > max_samples) {
        throw std::length_error("more samples than a scan can carry");
    }
    scan.Clear();
    write_angles(content, format, scan);
    write_distances(samples, format.distance_unit_um, scan);
    if (format.leave_out_quality) {
        scan.add_left_out(v1::QUALITY);
    } else {
        write_qualities(samples, scan);
    }
    if (format.leave_out_flags) {
        scan.add_left_out(v1::FLAG);
    } else {
        write_flags(samples, scan);
    }
    write_times(content, format.leave_out_times, scan);
    scan.set_period_us(to_uint32(content.period.count()));
    scan.set_mode(protocol::printable(content.mode));
    scan.set_answer_type(static_cast<std::uint32_t>(content.answer_type));
    scan.set_checksum_errors(content.losses.checksum_errors);
    scan.set_skipped_bytes(content.losses.skipped_bytes);
    scan.set_discarded_samples(content.losses.discarded_samples);
    scan.set_lost_packets(content.losses.lost_packets);
}

}  // namespace sweepcast::frame
