// LidarIds: sees to it that no two lidars of a gateway go by the same name.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace sweepcast::gateway {

/// Safe from any thread; used when a lidar is added or first identified.
class LidarIds {
public:
    /// The id of lidar `number`: `wished` if no other lidar has it, else `longer`, else `longer`
    /// with the number.
    std::string claim(std::uint32_t number, const std::string& wished, const std::string& longer);

private:
    [[nodiscard]] bool free_for(std::uint32_t number, const std::string& id) const;

    std::mutex mutex_;
    std::map<std::uint32_t, std::string> ids_;
};

}  // namespace sweepcast::gateway
