// The values that GET_LIDAR_CONF asks for.
#pragma once

#include "driver/virtual/answers.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::virtual_lidar {

/// The value of `type`: empty if the scanner does not know the type, or has no scan mode of the id
/// in `arguments`. The answer is then the echoed type alone. Source: protocol.md 3.
[[nodiscard]] std::vector<std::uint8_t> conf_value(
    protocol::ConfType type,
    std::span<const std::uint8_t> arguments,
    const Persona& persona,
    const Unit& unit
);

}  // namespace sweepcast::virtual_lidar
