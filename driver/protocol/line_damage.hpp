// LineDamage: accounts for the bytes between two good packets of a stream out of step.
#pragma once

#include "driver/protocol/decoded.hpp"

#include <cstddef>

namespace sweepcast::protocol {

/// What is known of the bytes since the last good packet.
class LineDamage {
public:
    /// A packet of `packet_size` bytes that is not intact follows the last good one. If it begins
    /// as packets do (`sync_followed`), it counts as a checksum error and is accounted for by that;
    /// else its bytes are skipped ones.
    LineDamage(std::size_t packet_size, bool sync_followed, Decoded& out);

    /// `count` bytes from the front belong to no packet.
    void give_up(std::size_t count, Decoded& out);
    /// Tells what was skipped and not yet told.
    void report_skipped(Decoded& out);

    [[nodiscard]] std::size_t given_up() const { return given_up_; }
    [[nodiscard]] bool sync_followed() const { return accounted_for_ > 0; }

private:
    std::size_t accounted_for_;  ///< bytes of the packet that a checksum error was told for
    std::size_t given_up_{};
    std::size_t unreported_{};
};

}  // namespace sweepcast::protocol
