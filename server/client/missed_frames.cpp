#include "server/client/missed_frames.hpp"

#include "server/client/known_lidars.hpp"
#include "sweepcast/v1/stream.pb.h"

namespace sweepcast::client {

std::optional<std::uint64_t> MissedFrames::before(const v1::Frame& frame) {
    const bool is_new = !last_.contains(frame.lidar());
    if (is_new && (last_.size() >= most_lidars || frame.lidar().size() > longest_lidar_name)) {
        return std::nullopt;
    }
    const bool sector = frame.kind() == v1::SECTOR;
    const auto [entry, is_first] = last_.try_emplace(frame.lidar());
    const Last last = entry->second;
    entry->second = {frame.sequence(), frame.sector(), !sector || frame.last()};
    if (is_first || frame.sequence() < last.sequence) {
        return std::uint64_t{0};  // nothing to compare with, or the lidar's gateway began anew
    }
    const std::uint64_t gap = frame.sequence() - last.sequence;
    if (!sector) {
        const std::uint64_t missing = gap > 0 ? gap - 1 : 0;
        return missing > frame.omitted() ? missing - frame.omitted() : 0;
    }
    if (gap == 0) {  // sector 0 again: the turn began anew
        return frame.sector() > last.sector ? frame.sector() - last.sector - 1 : 0;
    }
    return (last.complete ? 0 : 1) + (gap - 1) + frame.sector();
}

}  // namespace sweepcast::client
