// A sweep in plain units for programs that ask once: JSON and CSV.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "sweepcast/v1/api.pb.h"

#include <string>

namespace sweepcast::api {

void to_message(const device::CapturedSweep& captured, v1::LatestScan& scan);

/// Header line `angle_deg,distance_mm,quality,time_us`, then a line a sample; times are
/// microseconds after the first sample's.
[[nodiscard]] std::string to_csv(const device::CapturedSweep& captured);

}  // namespace sweepcast::api
