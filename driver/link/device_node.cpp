#include "driver/link/device_node.hpp"

#include <filesystem>
#include <system_error>

namespace sweepcast::link {

std::string device_node(const std::string& path) {
    std::error_code not_there;
    const auto node = std::filesystem::canonical(path, not_there);
    return not_there ? path : node.string();
}

}  // namespace sweepcast::link
