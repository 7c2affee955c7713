// What the checks of a scan say: does the motor turn, do revolutions come, how clean is the line,
// is the speed plausible. Pure.
#pragma once

#include "driver/device/line_quality.hpp"
#include "driver/device/rotation.hpp"
#include "driver/diagnosis/finding.hpp"
#include "driver/diagnosis/heard.hpp"
#include "driver/link/port_list.hpp"
#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/model.hpp"
#include "driver/protocol/reply.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace sweepcast::diagnosis {

/// A scan from its request to its first samples.
struct SpinLook {
    std::string model;  ///< its name
    protocol::MotorControl control{};
    std::string mode;
    bool accepted{};  ///< the request was answered with a descriptor
    std::uint64_t samples{};
    std::chrono::milliseconds waited{};  ///< for the first sample, or in vain
    Heard heard;                         ///< what came instead of samples
    bool gone{};                         ///< the port vanished meanwhile
    /// What the lidar said when it was asked again after samples had not come; unset: nothing.
    std::optional<protocol::Health> health_after{};
};

[[nodiscard]] Finding judge_motor(const SpinLook& spin);

/// The samples until the first revolutions were complete.
struct SweepLook {
    std::uint64_t sweeps{};
    std::uint64_t samples{};  ///< of the last complete revolution; of all if there is none
    std::uint64_t echoes{};   ///< those of them that have a distance
    std::chrono::milliseconds waited{};
};

[[nodiscard]] Finding judge_sweep(const SweepLook& sweep);

/// What came over the line during some revolutions.
struct QualityLook {
    protocol::AnswerType type{};
    device::LineQuality line;
    std::optional<link::SerialPort> adapter{};

    /// The part of the packets, or of the bytes if that is more, that was damaged or lost: 0..1.
    [[nodiscard]] double damage() const;
};

/// From this part on the line is called disturbed. A good line has no damage at all; a capsule lost
/// in two hundred is a gap in every tenth to twentieth revolution.
inline constexpr double damage_to_warn_of = 0.005;
/// From this part on the line is called bad: every or every second revolution has gaps.
inline constexpr double damage_to_fail_at = 0.05;

[[nodiscard]] Finding judge_quality(const QualityLook& quality);

/// Speeds beyond these are no lidar's.
inline constexpr double slowest_plausible_hz = 2.0;
inline constexpr double fastest_plausible_hz = 20.0;
/// How far the measured speed may be from the wanted one. It settles within seconds, to 2 % where
/// it is regulated; an A1's depends on its supply.
inline constexpr double speed_tolerance = 0.2;

[[nodiscard]] Finding judge_speed(const device::Rotation& rotation);

}  // namespace sweepcast::diagnosis
