// What lidars publish: frames in every form that somebody wants, and news of their state.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "server/frame/wire_message.hpp"
#include "server/frame/wish.hpp"
#include "server/hub/lidar_snapshot.hpp"
#include "server/hub/variant.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace sweepcast::hub {

/// A frame in one form.
struct VariantFrame {
    VariantPtr variant;
    frame::WireMessagePtr message;
    /// Not the one that was published before: that one only goes to who comes new, while the
    /// variant leaves this sweep out.
    bool is_new{true};
};

/// One sweep of one lidar: frames of it, and the last sectors of it. Who is to get a sweep in a
/// form that is not among them gets it all the same.
struct SweepNews {
    std::uint32_t lidar{};
    std::shared_ptr<const device::CapturedSweep> sweep;
    std::vector<VariantFrame> frames;
};

/// Sectors of a sweep under way.
struct SectorNews {
    std::uint32_t lidar{};
    std::vector<VariantFrame> frames;
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
    frame::Wish frames;
};

}  // namespace sweepcast::hub
