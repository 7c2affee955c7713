#include "driver/virtual/recording.hpp"

#include "driver/virtual/error.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

namespace sweepcast::virtual_lidar {

Result<Recording, Problem> Recording::create(const std::string& path) {
    errno = 0;
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    if (!file) {
        return Problem{
            errc::recording_unavailable,
            path + ": cannot write the recording: " + std::strerror(errno),
            "choose a file in a folder that exists and that you may write to",
        };
    }
    return Recording(std::move(file));
}

bool Recording::append(std::span<const std::uint8_t> bytes) {
    for (const auto byte : bytes) {
        file_.put(static_cast<char>(byte));
    }
    file_.flush();
    return file_.good();
}

}  // namespace sweepcast::virtual_lidar
