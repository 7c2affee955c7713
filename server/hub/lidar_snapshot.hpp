// LidarSnapshot: a lidar as the gateway knows it at one moment; immutable and shared by all
// workers.
#pragma once

#include "driver/device/device_state.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace sweepcast::hub {

struct LidarSnapshot {
    /// Its place in the list, from 1; constant, unlike the id.
    std::uint32_t number{};
    /// The short serial number once identified, the port's name before.
    std::string id;
    /// The port's name: goes on naming the lidar when the id has become its serial number.
    std::string port_name;
    std::string url;
    bool is_virtual{};
    /// A virtual one, started because no lidar was found.
    bool is_stand_in{};
    device::DeviceState state;
};

using LidarSnapshotPtr = std::shared_ptr<const LidarSnapshot>;

}  // namespace sweepcast::hub
