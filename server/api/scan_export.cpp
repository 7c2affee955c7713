#include "server/api/scan_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <limits>
#include <vector>

namespace sweepcast::api {

namespace {

std::int64_t microseconds_after(protocol::SampleTime first, protocol::SampleTime time) {
    return (time - first).count();
}

/// Returns how long after `first` a sample was taken, or the nearest value that the message holds.
/// A gateway that the scan comes from may say any time.
std::int32_t bounded_microseconds_after(protocol::SampleTime first, protocol::SampleTime time) {
    using Limits = std::numeric_limits<std::int32_t>;
    return static_cast<std::int32_t>(
        std::clamp<std::int64_t>(microseconds_after(first, time), Limits::min(), Limits::max())
    );
}

/// Sets the UNIX time of a moment, if it is known. Adds microseconds, because the nanoseconds of a
/// hostile gateway's time may not fit into 64 bits.
void set_time(
    protocol::SampleTime moment,
    std::chrono::nanoseconds monotonic_to_unix,
    v1::LatestScan& scan
) {
    const auto offset = std::chrono::floor<std::chrono::microseconds>(monotonic_to_unix);
    const auto unix_time = moment.time_since_epoch() + offset;
    if (unix_time.count() <= 0) {
        return;
    }
    const auto seconds = std::chrono::floor<std::chrono::seconds>(unix_time);
    const std::chrono::nanoseconds rest = unix_time - seconds + (monotonic_to_unix - offset);
    scan.mutable_time()->set_seconds(seconds.count());
    scan.mutable_time()->set_nanos(static_cast<std::int32_t>(rest.count()));
}

/// When the earliest of the samples was taken; there must be one. Bins go by angle, not by time.
protocol::SampleTime earliest(const std::vector<protocol::Sample>& samples) {
    return std::ranges::min_element(samples, {}, &protocol::Sample::time)->time;
}

}  // namespace

void to_message(const device::CapturedSweep& captured, v1::LatestScan& scan) {
    const auto& samples = captured.sweep.samples;
    scan.set_lidar(captured.lidar);
    scan.set_sequence(captured.sequence);
    scan.set_mode(captured.mode);
    scan.set_rotation_hz(captured.sweep.rotation_hz());
    if (samples.empty()) {
        return;
    }
    const auto first = earliest(samples);
    set_time(first, captured.monotonic_to_unix, scan);
    for (const auto& sample : samples) {
        scan.add_angle_deg(sample.angle.degrees());
        scan.add_distance_mm(sample.distance.millimetres());
        scan.add_quality(sample.quality);
        scan.add_time_us(bounded_microseconds_after(first, sample.time));
    }
}

std::uint32_t
age_ms(const device::CapturedSweep& captured, std::chrono::steady_clock::time_point now) {
    constexpr std::int64_t most = std::numeric_limits<std::uint32_t>::max();
    if (captured.sweep.samples.empty()) {
        return 0;
    }
    const auto age =
        std::chrono::floor<std::chrono::milliseconds>(now - captured.sweep.samples.back().time);
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(age.count(), 0, most));
}

std::string to_csv(const device::CapturedSweep& captured) {
    std::string text = "angle_deg,distance_mm,quality,time_us\n";
    const auto& samples = captured.sweep.samples;
    const auto first = samples.empty() ? protocol::SampleTime{} : earliest(samples);
    for (const auto& sample : samples) {
        fmt::format_to(
            std::back_inserter(text),
            "{:.4f},{:.2f},{},{}\n",
            sample.angle.degrees(),
            sample.distance.millimetres(),
            sample.quality,
            microseconds_after(first, sample.time)
        );
    }
    return text;
}

}  // namespace sweepcast::api
