// Answers of one packet, descriptor included, as a persona gives them.
#pragma once

#include "driver/protocol/lidar_conf.hpp"
#include "driver/protocol/reply.hpp"
#include "driver/protocol/request.hpp"
#include "driver/virtual/persona.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace sweepcast::virtual_lidar {

/// What answers depend on besides the persona.
struct Unit {
    SerialNumber serial{};
    protocol::Health health{};
    bool on_ethernet{};  ///< it has an address of its own
    /// What scanners with Ethernet come with (protocol.md 1.1).
    protocol::StaticIp static_ip{
        .address = {192, 168, 11, 2},
        .netmask = {255, 255, 255, 0},
        .gateway = {192, 168, 11, 1}};
    bool says_no_sample_time{};  ///< reports 0 us per sample (protocol.md 13.14)
    bool echoes_confs{};         ///< answers every GET_LIDAR_CONF with the bare type (13.15)
};

/// The bytes of the answer to a request that has one of a single packet. None for every other
/// request, for what the firmware does not know, and for payloads too short for it to be
/// understood: a scanner stays silent then. SET_LIDAR_CONF changes `unit`. Source: protocol.md 2,
/// 3, 4.4.
[[nodiscard]] std::optional<std::vector<std::uint8_t>>
answer_to(const protocol::Request& request, const Persona& persona, Unit& unit);

}  // namespace sweepcast::virtual_lidar
