// What virtual lidars are told to suffer.
#pragma once

#include <array>
#include <string_view>

namespace sweepcast::chaos {

/// A fault that lasts or happens once, and whether bytes that the host takes for measurements may
/// be others than were measured.
struct Fault {
    std::string_view command;
    std::string_view ends_with;  ///< empty: by itself
    bool damages{};
};

inline constexpr std::array faults{
    Fault{"unplug", "replug", false},
    Fault{"unplug", "replug", false},
    Fault{"fault mute", "clear mute", false},
    Fault{"fault deaf", "clear deaf", false},
    Fault{"fault motor-stall", "clear motor-stall", false},
    Fault{"fault burst=16", "clear burst", false},
    Fault{"fault burst=60", "clear burst", false},
    Fault{"fault delay=50", "clear delay", false},
    Fault{"fault delay=300", "clear delay", false},
    Fault{"fault slow-spin-up=3", "clear slow-spin-up", false},
    Fault{"fault sample-time-zero", "clear sample-time-zero", false},
    Fault{"fault bare-echo", "clear bare-echo", false},
    Fault{"fault warning", "clear warning", false},
    Fault{"fault protection-stop", "clear protection-stop", false},
    Fault{"protection-stop", "", false},
    Fault{"protection-stop=0x8001", "", false},
    Fault{"reboot", "", false},
    Fault{"angle-restart", "", false},
    Fault{"fault junk", "clear junk", true},
    Fault{"fault noise=0.001", "clear noise", true},
    Fault{"fault noise=0.05", "clear noise", true},
    Fault{"fault drop=0.001", "clear drop", true},
    Fault{"fault drop=0.05", "clear drop", true},
    Fault{"fault duplicate=0.01", "clear duplicate", true},
    Fault{"fault garbage", "clear garbage", true},
    Fault{"fault flood", "clear flood", true},
    Fault{"fault wrong-baud", "clear wrong-baud", true},
    Fault{"fault lying-length", "clear lying-length", true},
    Fault{"fault lying-length=3", "clear lying-length", true},
    Fault{"fault half-answers", "clear half-answers", true},
    Fault{"fault banner", "clear banner", true},
    Fault{"half-answer", "", true},
    Fault{"banner", "", true},
    Fault{"loss=1", "", true},
    // "clear" does not end it: more would cost a lidar that does not scan all its answers for long.
    Fault{"loss=60", "", true},
};

}  // namespace sweepcast::chaos
