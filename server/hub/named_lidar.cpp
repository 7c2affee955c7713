#include "server/hub/named_lidar.hpp"

namespace sweepcast::hub {

namespace {

constexpr std::size_t digits_of_id = 8;

/// How well a name fits a lidar, the best fit first.
enum class Fit { id, serial_number, first_digits, port_name, none };

Fit fit_of(const LidarNames& lidar, std::string_view name) {
    if (name.empty()) {
        return Fit::none;
    }
    const std::string_view serial = lidar.serial_number;
    if (lidar.id == name) {
        return Fit::id;
    }
    if (serial == name) {
        return Fit::serial_number;
    }
    if (serial.substr(0, digits_of_id) == name) {
        return Fit::first_digits;
    }
    return lidar.port_name == name ? Fit::port_name : Fit::none;
}

}  // namespace

NamedLidar find_named(std::span<const LidarNames> lidars, std::string_view name) {
    NamedLidar found;
    auto best = Fit::none;
    for (std::size_t i = 0; i < lidars.size(); ++i) {
        const auto fit = fit_of(lidars[i], name);
        if (fit < best) {
            best = fit;
            found = {i, false};
        } else if (fit == best && fit != Fit::none) {
            found = {std::nullopt, true};
        }
    }
    return found;
}

}  // namespace sweepcast::hub
