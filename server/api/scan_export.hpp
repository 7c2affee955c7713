// A sweep in plain units for programs that ask once: JSON and CSV.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "sweepcast/v1/api.pb.h"

#include <chrono>
#include <cstdint>
#include <string>

namespace sweepcast::api {

/// Fills in what is known of the sweep itself: all but `state` and `age_ms`. `time` is not set if
/// the gateway does not know the wall clock's time.
void to_message(const device::CapturedSweep& captured, v1::LatestScan& scan);

/// Returns how many milliseconds before `now` the last sample of the sweep was measured; 0 for a
/// sweep without samples.
[[nodiscard]] std::uint32_t
age_ms(const device::CapturedSweep& captured, std::chrono::steady_clock::time_point now);

/// Header line `angle_deg,distance_mm,quality,time_us`, then one line per sample; times are
/// microseconds after the earliest sample's.
[[nodiscard]] std::string to_csv(const device::CapturedSweep& captured);

}  // namespace sweepcast::api
