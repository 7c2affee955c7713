#include "server/client/known_lidars.hpp"

#include "sweepcast/v1/lidar.pb.h"
#include "sweepcast/v1/stream.pb.h"

#include <algorithm>

namespace sweepcast::client {

std::uint64_t KnownLidars::begin(v1::Hello& hello) {
    numbers_.clear();
    auto& lidars = *hello.mutable_lidars();
    const auto left_out = std::remove_if(lidars.begin(), lidars.end(), [this](const auto& lidar) {
        return !admit(lidar);
    });
    const auto count = lidars.end() - left_out;
    lidars.erase(left_out, lidars.end());
    return static_cast<std::uint64_t>(count);
}

bool KnownLidars::admit(const v1::Lidar& lidar) {
    // In memory, not on the wire: there an empty part of a list takes two bytes only.
    if (lidar.id().size() > longest_lidar_name || lidar.SpaceUsedLong() > most_lidar_memory) {
        return false;
    }
    if (numbers_.size() >= most_lidars) {
        return numbers_.contains(lidar.number());
    }
    numbers_.insert(lidar.number());
    return true;
}

}  // namespace sweepcast::client
