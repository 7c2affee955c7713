// Columns -> samples, one function a column. Nothing in a column is believed.
#include "server/frame/angle_units.hpp"
#include "server/frame/error.hpp"
#include "server/frame/scan_columns.hpp"
#include "server/frame/zigzag.hpp"
#include "sweepcast/v1/scan.pb.h"

#include <limits>
#include <span>
#include <utility>

namespace sweepcast::frame {

namespace {

using protocol::Sample;
using Samples = std::span<Sample>;

constexpr std::uint32_t largest_byte = 255;

/// Whether every column has as many entries as `count` samples need.
Result<void> check_lengths(const v1::Scan& scan, std::size_t count) {
    if (count > max_samples) {
        return error_code(errc::too_many_samples);
    }
    const auto distances = static_cast<std::size_t>(scan.distance_size());
    const auto residuals = static_cast<std::size_t>(scan.time_residual_size());
    const std::size_t steps = count == 0 ? 0 : count - 1;
    const bool fit = distances == count &&
                     (scan.quality().empty() || scan.quality().size() == count) &&
                     (residuals == 0 || residuals == steps) &&
                     static_cast<std::size_t>(scan.flag_index_size()) == scan.flag_value().size();
    return fit ? Result<void>{} : error_code(errc::column_length_wrong);
}

Result<void> read_angles(const v1::Scan& scan, Samples samples) {
    if (scan.angle_units_per_turn() != q6_per_turn && scan.angle_units_per_turn() != q14_per_turn) {
        return error_code(errc::unit_unknown);
    }
    const bool q6 = scan.angle_units_per_turn() == q6_per_turn;
    const std::int64_t turn = scan.angle_units_per_turn();
    std::int64_t angle = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const std::int64_t step = scan.angle(static_cast<int>(i));
        if (step >= turn || step <= (i == 0 ? -1 : -turn)) {  // the first is an angle itself
            return error_code(errc::angle_out_of_range);
        }
        angle += step;
        angle += angle < 0 ? turn : (angle >= turn ? -turn : 0);
        const auto units = static_cast<std::uint32_t>(angle);
        samples[i].angle =
            q6 ? from_q6(units) : protocol::AngleQ14{static_cast<std::uint16_t>(units)};
    }
    return {};
}

Result<void> read_distances(const v1::Scan& scan, Samples samples) {
    if (scan.distance_unit_um() != 1000 && scan.distance_unit_um() != 250) {
        return error_code(errc::unit_unknown);
    }
    const std::int64_t scale = scan.distance_unit_um() / 250;
    const std::int64_t farthest = std::numeric_limits<std::uint32_t>::max() / scale;
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
        samples[i].distance.raw = static_cast<std::uint32_t>(distance * scale);
    }
    return {};
}

/// After the distances: without a column they tell which samples have a quality.
Result<void> read_qualities(const v1::Scan& scan, Samples samples) {
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

Result<void> read_flags(const v1::Scan& scan, Samples samples) {
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

/// Any time is one that a sample can have: steps count modulo 2^64, as they were made.
void read_times(const v1::Scan& scan, Samples samples) {
    std::uint64_t time = scan.first_monotonic_us();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (i > 0) {
            time += scan.sample_period_us();
            if (scan.time_residual_size() > 0) {
                time += static_cast<std::uint64_t>(scan.time_residual(static_cast<int>(i - 1)));
            }
        }
        samples[i].time =
            protocol::SampleTime(std::chrono::microseconds(static_cast<std::int64_t>(time)));
    }
}

Result<void> read_samples(const v1::Scan& scan, Samples samples) {
    for (const auto read : {read_angles, read_distances, read_qualities, read_flags}) {
        if (auto done = read(scan, samples); !done) {
            return done;
        }
    }
    read_times(scan, samples);
    return {};
}

}  // namespace

Result<DecodedScan> from_columns(const v1::Scan& scan) {
    const auto count = static_cast<std::size_t>(scan.angle_size());
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
    decoded.sample_period = std::chrono::microseconds(scan.sample_period_us());
    decoded.first_unix = std::chrono::nanoseconds(static_cast<std::int64_t>(scan.first_unix_ns()));
    return decoded;
}

}  // namespace sweepcast::frame
