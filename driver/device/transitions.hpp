// What happens to a lidar, and where that leads, as a table. Drawn in STATES.md.
#pragma once

#include "driver/device/phase.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace sweepcast::device {

enum class Event : std::uint8_t {
    attempt,   ///< its port is about to be opened
    no_port,   ///< there is no such port
    opened,    ///< the port is open
    examine,   ///< an examination has the port to itself
    rest,      ///< in hand, and no scan is wanted
    start,     ///< in hand, and a scan is wanted
    samples,   ///< the first samples of the scan
    stop,      ///< the scan is being ended, or begun anew with other settings
    stall,     ///< the scan brings no samples or no turns any more, or did not begin
    protect,   ///< the lidar says that it is in protection stop
    reset,     ///< it is told to boot
    give_up,   ///< it has been reset in vain as often as it may be
    lost,      ///< the line broke, or the lidar does not answer, or its port cannot be had
    shutdown,  ///< the gateway ends
};

/// In words: "no port".
[[nodiscard]] std::string_view name(Event event);

struct Transition {
    Phase from;
    Event event;
    Phase to;
    bool operator==(const Transition&) const = default;
};

/// The whole table, each pair of phase and event at most once.
[[nodiscard]] std::span<const Transition> transitions();

/// Where `event` leads from `from`; nothing if it must not happen there.
[[nodiscard]] std::optional<Phase> next(Phase from, Event event);

}  // namespace sweepcast::device
