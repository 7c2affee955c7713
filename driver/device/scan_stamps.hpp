// ScanStamps: what the sweeps of one lidar have in common over all its scans: their numbers, how
// their times relate to the wall clock, and the gaps between scans.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "driver/device/scan_mode.hpp"
#include "driver/device/sweep_progress.hpp"
#include "driver/device/wall_clock.hpp"
#include "driver/protocol/sweep.hpp"

#include <chrono>
#include <cstdint>
#include <optional>

namespace sweepcast::device {

class ScanStamps {
public:
    /// A scan in `mode` begins; whatever comes next follows after a gap.
    void begin_scan(const ScanMode& mode);

    /// The complete sweep as its user gets it.
    [[nodiscard]] CapturedSweep stamp(protocol::Sweep sweep, protocol::AnswerType type);

    /// The sweep under way as its user is told of it. Refers to `sweep` and to this.
    [[nodiscard]] SweepProgress stamp(
        const protocol::UnfinishedSweep& sweep,
        protocol::AnswerType type,
        protocol::SampleTime arrival
    );

    [[nodiscard]] const ScanMode& mode() const { return mode_; }

private:
    void begin_sweep(std::uint64_t begun, protocol::SampleTime first);

    ScanMode mode_;
    std::uint64_t sequence_{};
    std::uint64_t begun_{};              ///< sweeps, in all scans
    std::uint64_t begun_before_scan_{};  ///< in those before the running one
    WallClock wall_clock_;
    std::chrono::nanoseconds monotonic_to_unix_{};   ///< of the sweep under way
    std::chrono::nanoseconds clock_step_{};          ///< since the one told last
    std::chrono::nanoseconds gap_{};                 ///< before the sweep under way
    bool after_gap_{};                               ///< no sweep of this scan is complete
    std::optional<protocol::SampleTime> last_seen_;  ///< the end of the last complete sweep
};

}  // namespace sweepcast::device
