// Answers of one packet, descriptor included, as a persona gives them.
#pragma once

#include "driver/protocol/reply.hpp"
#include "driver/protocol/request.hpp"
#include "driver/virtual/persona.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sweepcast::virtual_lidar {

/// The bytes of the answer to a request that has one of a single packet. None for every other
/// request, and for payloads too short for it to be understood: a scanner stays silent then.
/// Source: protocol.md 2, 3.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> answer_to(
    const protocol::Request& request,
    const Persona& persona,
    const SerialNumber& serial,
    const protocol::Health& health
);

/// The value that GET_LIDAR_CONF of `type` has: empty if the persona does not know the type, or has
/// no scan mode of the id in `arguments`. The answer is then the echoed type alone. Source:
/// protocol.md 3.
[[nodiscard]] std::vector<std::uint8_t>
conf_value(const Persona& persona, std::uint32_t type, std::span<const std::uint8_t> arguments);

}  // namespace sweepcast::virtual_lidar
