// A lidar's snapshot as the schema's Lidar message: one translation for the stream and the HTTP
// API.
#pragma once

#include "server/hub/lidar_snapshot.hpp"
#include "sweepcast/v1/lidar.pb.h"

namespace sweepcast::stream {

void to_message(const hub::LidarSnapshot& lidar, v1::Lidar& message);

/// The inverse, as far as the lidar's own state goes: as another gateway tells it. What is
/// malformed is taken for not told.
[[nodiscard]] device::DeviceState from_message(const v1::Lidar& message);

}  // namespace sweepcast::stream
