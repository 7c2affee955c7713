#include "driver/virtual/world.hpp"

#include "driver/virtual/error.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace sweepcast::virtual_lidar {

namespace {

Problem unreadable(const std::string& path, const std::string& why) {
    return {
        errc::world_unreadable,
        path + ": " + why,
        "give a readable CSV file of points, or leave it out for the built-in living room",
    };
}

// A bounded read of a plain file: a pipe could block for ever and a device may have no end.
Result<std::string, Problem> read_text(const std::string& path) {
    std::error_code status_failure;
    const auto status = std::filesystem::status(path, status_failure);
    if (status_failure || !std::filesystem::exists(status)) {
        return unreadable(path, status_failure ? status_failure.message() : std::strerror(ENOENT));
    }
    if (!std::filesystem::is_regular_file(status)) {
        return unreadable(path, "not a regular file");
    }
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        return unreadable(path, std::strerror(errno));
    }
    std::string text;
    constexpr std::size_t chunk = 64UL << 10U;
    while (file && text.size() <= max_points_file_bytes) {
        const auto before = text.size();
        text.resize(before + chunk);
        file.read(text.data() + before, static_cast<std::streamsize>(chunk));
        text.resize(before + static_cast<std::size_t>(file.gcount()));
    }
    if (file.bad()) {
        return unreadable(path, "reading failed");
    }
    return text;
}

}  // namespace

Result<World, Problem> World::load(const std::string& path) {
    auto text = read_text(path);
    if (!text) {
        return std::move(text).error();
    }
    auto map = PolarMap::parse(*text, path);
    if (!map) {
        return std::move(map).error();
    }
    return World(std::move(*map));
}

std::optional<double> World::distance_mm(double angle_deg, Seconds t) const {
    if (const auto* const map = std::get_if<PolarMap>(&world_)) {
        return map->distance_mm(angle_deg);
    }
    return living_room_distance_mm(angle_deg, t);
}

}  // namespace sweepcast::virtual_lidar
