// The one name of a device behind all those that lead to it.
#pragma once

#include <string>

namespace sweepcast::link {

/// The device file that `path` leads to, links resolved, e.g. "/dev/ttyUSB0"; `path` itself if it
/// leads nowhere.
std::string device_node(const std::string& path);

}  // namespace sweepcast::link
