#include "driver/device/transitions.hpp"

#include <algorithm>
#include <array>

namespace sweepcast::device {

namespace {

using enum Phase;

constexpr std::array table{
    Transition{disconnected, Event::attempt, opening},
    Transition{identifying, Event::attempt, opening},  // after an examination
    Transition{backing_off, Event::attempt, opening},
    Transition{absent, Event::attempt, absent},  // until the port is there

    Transition{opening, Event::no_port, absent},
    Transition{absent, Event::no_port, absent},
    Transition{opening, Event::opened, identifying},
    Transition{absent, Event::opened, identifying},

    Transition{disconnected, Event::examine, identifying},
    Transition{absent, Event::examine, identifying},
    Transition{opening, Event::examine, identifying},
    Transition{identifying, Event::examine, identifying},
    Transition{backing_off, Event::examine, identifying},
    Transition{stalled, Event::examine, identifying},
    Transition{resetting, Event::examine, identifying},

    Transition{identifying, Event::rest, idle},
    Transition{idle, Event::rest, idle},
    Transition{stopping, Event::rest, idle},
    Transition{stalled, Event::rest, idle},
    Transition{resetting, Event::rest, idle},
    Transition{protection_stop, Event::rest, idle},
    Transition{failed, Event::rest, idle},

    Transition{identifying, Event::start, starting},
    Transition{idle, Event::start, starting},
    Transition{stopping, Event::start, starting},
    Transition{stalled, Event::start, starting},
    Transition{resetting, Event::start, starting},
    Transition{protection_stop, Event::start, starting},
    Transition{failed, Event::start, starting},

    Transition{starting, Event::samples, scanning},
    Transition{stalled, Event::samples, scanning},  // a hiccup
    Transition{starting, Event::stop, stopping},
    Transition{scanning, Event::stop, stopping},
    Transition{stalled, Event::stop, stopping},
    Transition{starting, Event::stall, stalled},
    Transition{scanning, Event::stall, stalled},
    Transition{stalled, Event::stall, stalled},

    Transition{identifying, Event::protect, protection_stop},
    Transition{idle, Event::protect, protection_stop},
    Transition{stopping, Event::protect, protection_stop},
    Transition{stalled, Event::protect, protection_stop},
    Transition{resetting, Event::protect, protection_stop},
    Transition{protection_stop, Event::protect, protection_stop},
    Transition{failed, Event::protect, protection_stop},

    Transition{identifying, Event::reset, resetting},
    Transition{idle, Event::reset, resetting},
    Transition{stopping, Event::reset, resetting},
    Transition{stalled, Event::reset, resetting},
    Transition{resetting, Event::reset, resetting},
    Transition{protection_stop, Event::reset, resetting},
    Transition{failed, Event::reset, resetting},
    Transition{protection_stop, Event::give_up, failed},
    Transition{failed, Event::give_up, failed},

    Transition{absent, Event::lost, backing_off},
    Transition{opening, Event::lost, backing_off},
    Transition{identifying, Event::lost, backing_off},
    Transition{idle, Event::lost, backing_off},
    Transition{starting, Event::lost, backing_off},
    Transition{scanning, Event::lost, backing_off},
    Transition{stalled, Event::lost, backing_off},
    Transition{stopping, Event::lost, backing_off},
    Transition{protection_stop, Event::lost, backing_off},
    Transition{resetting, Event::lost, backing_off},
    Transition{failed, Event::lost, backing_off},

    Transition{absent, Event::shutdown, disconnected},
    Transition{opening, Event::shutdown, disconnected},
    Transition{identifying, Event::shutdown, disconnected},
    Transition{idle, Event::shutdown, disconnected},
    Transition{starting, Event::shutdown, disconnected},
    Transition{scanning, Event::shutdown, disconnected},
    Transition{stalled, Event::shutdown, disconnected},
    Transition{stopping, Event::shutdown, disconnected},
    Transition{protection_stop, Event::shutdown, disconnected},
    Transition{resetting, Event::shutdown, disconnected},
    Transition{backing_off, Event::shutdown, disconnected},
    Transition{failed, Event::shutdown, disconnected},
    Transition{disconnected, Event::shutdown, disconnected},
};

}  // namespace

std::string_view name(Event event) {
    switch (event) {
    case Event::attempt:
        return "attempt";
    case Event::no_port:
        return "no port";
    case Event::opened:
        return "opened";
    case Event::examine:
        return "examine";
    case Event::rest:
        return "rest";
    case Event::start:
        return "start";
    case Event::samples:
        return "samples";
    case Event::stop:
        return "stop";
    case Event::stall:
        return "stall";
    case Event::protect:
        return "protect";
    case Event::reset:
        return "reset";
    case Event::give_up:
        return "give up";
    case Event::lost:
        return "lost";
    case Event::shutdown:
        return "shutdown";
    }
    return "unknown";
}

std::span<const Transition> transitions() {
    return table;
}

std::optional<Phase> next(Phase from, Event event) {
    const auto* const row = std::ranges::find_if(table, [=](const Transition& each) {
        return each.from == from && each.event == event;
    });
    return row == table.end() ? std::nullopt : std::optional(row->to);
}

}  // namespace sweepcast::device
