#include "server/gateway/lidar_ids.hpp"

#include <algorithm>

namespace sweepcast::gateway {

std::string
LidarIds::claim(std::uint32_t number, const std::string& wished, const std::string& longer) {
    const std::scoped_lock lock(mutex_);
    auto id = wished;
    if (!free_for(number, id)) {
        id = longer;
    }
    if (!free_for(number, id)) {
        id = longer + "-" + std::to_string(number);
    }
    ids_[number] = id;
    return id;
}

bool LidarIds::free_for(std::uint32_t number, const std::string& id) const {
    return std::ranges::none_of(ids_, [&](const auto& entry) {
        return entry.first != number && entry.second == id;
    });
}

}  // namespace sweepcast::gateway
