// The personas by family; a file each, for they are mostly numbers.
#pragma once

#include "driver/virtual/persona.hpp"

#include <span>

namespace sweepcast::virtual_lidar {

/// A1, A2, A3.
[[nodiscard]] std::span<const Persona> triangulation_personas();

/// C, S and T series.
[[nodiscard]] std::span<const Persona> time_of_flight_personas();

}  // namespace sweepcast::virtual_lidar
