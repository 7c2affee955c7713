// SweepJoiner: puts the sectors of a lidar together to sweeps.
#pragma once

#include "server/client/event.hpp"
#include "server/frame/decoded_scan.hpp"

#include <cstdint>

namespace sweepcast::client {

/// The sweep under way, as far as its sectors have come.
struct JoinedSweep {
    std::uint64_t sequence{};
    /// Counts the sweeps begun, from 1: another number under the same sequence means that the lidar
    /// began its turn anew.
    std::uint64_t begun{};
    bool complete{};
    /// Period and losses are there once it is complete.
    frame::DecodedScan scan;
};

/// For one lidar.
class SweepJoiner {
public:
    /// Takes the next sector, or a whole sweep. False if it cannot be joined, because one before it
    /// did not come: then the sweep is lost, and the next one begins with its first sector.
    bool take(Scan scan);

    /// What the last scan taken belongs to.
    [[nodiscard]] const JoinedSweep& sweep() const { return sweep_; }

    /// Sweeps lost so far because a sector of them was missing.
    [[nodiscard]] std::uint64_t lost() const { return lost_; }

private:
    void begin(Scan scan);
    bool go_on(Scan scan);
    void lose();

    JoinedSweep sweep_;
    std::uint32_t next_sector_{};
    bool under_way_{};
    std::uint64_t last_lost_{};
    std::uint64_t lost_{};
};

}  // namespace sweepcast::client
