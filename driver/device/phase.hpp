// Phase: the stages of a lidar's life, as its users are told them.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace sweepcast::device {

/// What leads from one to the next: STATES.md, transitions.hpp.
enum class Phase : std::uint8_t {
    disconnected,     ///< the gateway has not begun with it, or has ended
    absent,           ///< its port is not there; met at once when it comes
    opening,          ///< the port is being opened, or the host connected to
    identifying,      ///< asking who and how it is
    idle,             ///< ready, motor off: stopped by its user, or nobody watches
    starting,         ///< motor on, waiting for the first samples
    scanning,         ///< samples are coming in
    stalled,          ///< samples or turns stopped coming; being started again
    stopping,         ///< ending the scan, motor going off
    protection_stop,  ///< the lidar switched itself off: only a reset helps
    resetting,        ///< told to boot; waiting until it has
    backing_off,      ///< it cannot be had or does not answer; tried again at `next_attempt`
    failed,           ///< resets do not help; needs its user
};

inline constexpr std::array all_phases{
    Phase::disconnected,
    Phase::absent,
    Phase::opening,
    Phase::identifying,
    Phase::idle,
    Phase::starting,
    Phase::scanning,
    Phase::stalled,
    Phase::stopping,
    Phase::protection_stop,
    Phase::resetting,
    Phase::backing_off,
    Phase::failed};

/// In words: "protection stop".
[[nodiscard]] std::string_view name(Phase phase);

}  // namespace sweepcast::device
