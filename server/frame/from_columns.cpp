// Columns -> samples, one function a column. Nothing in a column is believed.
#include "server/frame/angle_ramps.hpp"
#include "server/frame/angle_units.hpp"
#include "server/frame/distance_units.hpp"
#include "server/frame/error.hpp"
#include "server/frame/scan_columns.hpp"
#include "server/frame/zigzag.hpp"
#include "sweepcast/v1/scan.pb.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <ratio>
#include <span>
#include <utility>
#include <vector>

namespace sweepcast::frame {

namespace {

using protocol::Sample;
using MutableSamples = std::span<Sample>;

constexpr std::uint32_t largest_byte = 255;
constexpr std::uint64_t longest_gap = std::numeric_limits<std::int64_t>::max();

bool is_left_out(const v1::Scan& scan, v1::Column column) {
    return std::find(scan.left_out().begin(), scan.left_out().end(), column) !=
           scan.left_out().end();
}

/// Whether every column has as many entries as `count` samples need.
Result<void> check_lengths(const v1::Scan& scan, std::size_t count) {
    if (count > max_samples) {
        return error_code(errc::too_many_samples);
    }
    const auto angles = static_cast<std::size_t>(scan.angle_size());
    const bool fit = angles == (scan.has_ramps() ? 0 : count) &&
                     (scan.quality().empty() || scan.quality().size() == count) &&
                     static_cast<std::size_t>(scan.flag_index_size()) == scan.flag_value().size();
    return fit ? Result<void>{} : error_code(errc::column_length_wrong);
}

/// Adds up differences; nothing if a sum leaves the range that angles and corrections can have.
std::optional<std::vector<std::int32_t>> sums_of(
    const google::protobuf::RepeatedField<std::int32_t>& differences
) {
    // Far more turns than a scan can have, and far from what 32 bits hold.
    constexpr std::int64_t farthest = 1 << 28;
    std::vector<std::int32_t> sums;
    sums.reserve(static_cast<std::size_t>(differences.size()));
    std::int64_t sum = 0;
    for (const auto difference : differences) {
        sum += difference;
        if (sum < -farthest || sum > farthest) {
            return std::nullopt;
        }
        sums.push_back(static_cast<std::int32_t>(sum));
    }
    return sums;
}

Result<std::vector<AngleFix>> fixes_of(const v1::AngleRamps& message, std::size_t count) {
    std::vector<AngleFix> fixes;
    std::uint64_t index = 0;
    for (int i = 0; i < message.fix_size(); ++i) {
        const std::uint32_t step = message.fix_index(i);
        index += step;
        if ((step == 0 && i > 0) || index >= count) {
            return error_code(errc::angle_out_of_range);
        }
        fixes.push_back({static_cast<std::uint32_t>(index), message.fix(i)});
    }
    return fixes;
}

Result<void> read_ramps(const v1::AngleRamps& message, MutableSamples samples) {
    AngleRamps ramps;
    ramps.length = message.length();
    ramps.skip = message.skip();
    ramps.parallax = message.parallax();
    if (ramps.length == 0 || ramps.length > max_samples || ramps.skip >= ramps.length) {
        return error_code(errc::angle_out_of_range);
    }
    const auto corrections = static_cast<std::size_t>(message.correction_size());
    const std::size_t ramps_begun = (ramps.skip + samples.size() + ramps.length - 1) / ramps.length;
    const bool fit = static_cast<std::size_t>(message.start_size()) == ramps_begun + 1 &&
                     (corrections == 0 || corrections == samples.size()) &&
                     message.fix_size() == message.fix_index_size();
    if (!fit) {
        return error_code(errc::column_length_wrong);
    }
    auto starts = sums_of(message.start());
    auto corrected = sums_of(message.correction());
    if (!starts || !corrected) {
        return error_code(errc::angle_out_of_range);
    }
    auto fixes = fixes_of(message, samples.size());
    if (!fixes) {
        return fixes.error();
    }
    ramps.starts = std::move(*starts);
    ramps.corrections = std::move(*corrected);
    ramps.fixes = std::move(*fixes);
    apply_ramps(ramps, samples);
    return {};
}

Result<void> read_angles(const v1::Scan& scan, MutableSamples samples) {
    const std::uint32_t per_turn = scan.angle_units_per_turn();
    if (per_turn == 0 || per_turn > q14_per_turn) {
        return error_code(errc::unit_unknown);
    }
    if (scan.has_ramps()) {
        return per_turn == q6_per_turn ? read_ramps(scan.ramps(), samples)
                                       : Result<void>(error_code(errc::unit_unknown));
    }
    const std::int64_t turn = per_turn;
    std::int64_t angle = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const std::int64_t step = scan.angle(static_cast<int>(i));
        if (step >= turn || step <= (i == 0 ? -1 : -turn)) {  // the first is an angle itself
            return error_code(errc::angle_out_of_range);
        }
        angle += step;
        angle += angle < 0 ? turn : (angle >= turn ? -turn : 0);
        samples[i].angle = from_units(static_cast<std::uint32_t>(angle), per_turn);
    }
    return {};
}

/// Before the angles, which may depend on them.
Result<void> read_distances(const v1::Scan& scan, MutableSamples samples) {
    const std::uint32_t unit_um = scan.distance_unit_um();
    if (unit_um == 0 || unit_um > coarsest_um) {
        return error_code(errc::unit_unknown);
    }
    const auto farthest = static_cast<std::int64_t>(farthest_in(unit_um));
    std::int64_t distance = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const std::uint64_t token = scan.distance(static_cast<int>(i));
        if (token == 0) {
            continue;  // no echo
        }
        const std::int64_t step = unzigzag(token - 1);
        // Bounds the step before it is added: distance is within 0..farthest, so neither side can
        // overflow.
        if (step > farthest - distance || step < 1 - distance) {
            return error_code(errc::distance_out_of_range);
        }
        distance += step;
        samples[i].distance = distance_from_units(static_cast<std::uint64_t>(distance), unit_um);
    }
    return {};
}

/// After the distances: without a column they tell which samples have a quality.
Result<void> read_qualities(const v1::Scan& scan, MutableSamples samples) {
    if (scan.echo_quality() > largest_byte) {
        return error_code(errc::quality_out_of_range);
    }
    const auto usual = static_cast<std::uint8_t>(scan.echo_quality());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const auto constant = samples[i].distance.has_echo() ? usual : std::uint8_t{0};
        samples[i].quality =
            scan.quality().empty() ? constant : static_cast<std::uint8_t>(scan.quality()[i]);
    }
    return {};
}

Result<void> read_flags(const v1::Scan& scan, MutableSamples samples) {
    if (scan.flag() > largest_byte) {
        return error_code(errc::flag_out_of_range);
    }
    for (auto& sample : samples) {
        sample.flag = static_cast<std::uint8_t>(scan.flag());
    }
    std::uint64_t index = 0;  // the sum of 65536 steps of 32 bits fits
    for (int i = 0; i < scan.flag_index_size(); ++i) {
        const std::uint32_t step = scan.flag_index(i);
        index += step;
        if ((step == 0 && i > 0) || index >= samples.size()) {
            return error_code(errc::flag_out_of_range);
        }
        samples[index].flag =
            static_cast<std::uint8_t>(scan.flag_value()[static_cast<std::size_t>(i)]);
    }
    return {};
}

/// Whether the steps of the time column are for as many samples as there are.
bool steps_fit(const v1::Scan& scan, std::size_t samples) {
    std::uint64_t in_runs = 0;
    for (const auto count : scan.time_run()) {
        if (count == 0) {
            return false;
        }
        in_runs += count;  // of at most 2^31 entries of 32 bits
    }
    const std::size_t wanted = is_left_out(scan, v1::TIME) ? 0 : samples;
    return scan.time_step_ps_size() == scan.time_run_size() && in_runs == wanted;
}

/// The moment from which the time column counts.
protocol::SampleTime first_time(const v1::Scan& scan) {
    const auto first_ns =
        std::chrono::nanoseconds(static_cast<std::int64_t>(scan.first_monotonic_ns()));
    return protocol::SampleTime(std::chrono::floor<std::chrono::microseconds>(first_ns));
}

/// Any time is one that a sample can have: sums are modulo 2^64.
Result<void> read_times(const v1::Scan& scan, MutableSamples samples) {
    if (!steps_fit(scan, samples.size())) {
        return error_code(errc::column_length_wrong);
    }
    const auto first = first_time(scan);
    auto to_time = [first](std::uint64_t ps) {
        const std::chrono::duration<std::int64_t, std::pico> after(static_cast<std::int64_t>(ps));
        return first + std::chrono::floor<std::chrono::microseconds>(after);
    };
    std::uint64_t ps = 0;
    std::size_t i = 0;
    for (int run = 0; run < scan.time_run_size(); ++run) {
        for (std::uint32_t k = 0; k < scan.time_run(run); ++k, ++i) {
            ps += static_cast<std::uint64_t>(scan.time_step_ps(run));
            samples[i].time = to_time(ps);
        }
    }
    for (; i < samples.size(); ++i) {  // left out: nothing tells how far apart they are
        samples[i].time = first;
    }
    return {};
}

Result<void> read_samples(const v1::Scan& scan, MutableSamples samples) {
    for (const auto read : {read_distances, read_angles, read_qualities, read_flags, read_times}) {
        if (auto done = read(scan, samples); !done) {
            return done;
        }
    }
    return {};
}

}  // namespace

Result<DecodedScan> from_columns(const v1::Scan& scan) {
    const auto count = static_cast<std::size_t>(scan.distance_size());
    if (const auto fit = check_lengths(scan, count); !fit) {
        return fit.error();
    }
    const auto type = static_cast<protocol::AnswerType>(scan.answer_type());
    if (scan.answer_type() > largest_byte || protocol::packet_size(type) == 0) {
        return error_code(errc::answer_type_unknown);
    }
    DecodedScan decoded;
    decoded.sweep.samples.resize(count);
    if (const auto read = read_samples(scan, decoded.sweep.samples); !read) {
        return read.error();
    }
    decoded.sweep.period = std::chrono::microseconds(scan.period_us());
    decoded.sweep.losses = {
        scan.checksum_errors(),
        scan.skipped_bytes(),
        scan.discarded_samples(),
        scan.lost_packets()};
    decoded.mode = scan.mode();
    decoded.answer_type = type;
    decoded.sample_duration = std::chrono::nanoseconds(scan.sample_period_ns());
    decoded.first_time = first_time(scan);
    decoded.angle_units_per_turn = scan.angle_units_per_turn();
    decoded.first_unix = std::chrono::nanoseconds(static_cast<std::int64_t>(scan.first_unix_ns()));
    decoded.sweep.time_uncertainty = std::chrono::microseconds(scan.time_uncertainty_us());
    decoded.clock_step = std::chrono::nanoseconds(scan.wall_clock_step_ns());
    decoded.gap = std::chrono::nanoseconds(
        static_cast<std::int64_t>(std::min<std::uint64_t>(scan.gap_ns(), longest_gap))
    );
    decoded.without_quality = is_left_out(scan, v1::QUALITY);
    decoded.without_flags = is_left_out(scan, v1::FLAG);
    decoded.without_times = is_left_out(scan, v1::TIME);
    return decoded;
}

}  // namespace sweepcast::frame
