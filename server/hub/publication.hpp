// What lidars publish: sweeps with their encoded variants, and news of their state.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "server/frame/frame_encoder.hpp"
#include "server/frame/wire_message.hpp"
#include "server/hub/lidar_snapshot.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace sweepcast::hub {

/// A frame is made once for each of these, and only while somebody wants it.
constexpr std::size_t compression_count = 2;

/// One sweep of one lidar.
struct SweepNews {
    std::uint32_t lidar{};
    std::shared_ptr<const device::CapturedSweep> sweep;
    /// By compression; null where nobody wanted it.
    std::array<frame::WireMessagePtr, compression_count> frames;
};

/// A lidar's new state, and the message that tells it.
struct StateNews {
    LidarSnapshotPtr lidar;
    frame::WireMessagePtr message;
};

/// What one subscriber wants to get.
struct Wish {
    /// The lidar's number; none: all lidars.
    std::optional<std::uint32_t> lidar;
    frame::Compression compression{frame::Compression::zstd};
};

}  // namespace sweepcast::hub
