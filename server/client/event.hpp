// What a gateway's subscriber learns, one event after the other.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/frame/decoded_scan.hpp"
#include "sweepcast/v1/lidar.pb.h"
#include "sweepcast/v1/stream.pb.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

namespace sweepcast::client {

/// A connection is there, the first one or another one. The wish has been sent.
struct Connected {
    /// Names all lidars and their states.
    v1::Hello hello;
};

/// The connection is lost, or could not be had; it is tried again by itself.
struct Disconnected {
    Problem why;
    std::chrono::milliseconds retry_in{};
};

/// A sweep (one revolution), or a sector of one.
struct Scan {
    std::string lidar;  ///< its id
    /// Counts the lidar's sweeps; of a sector: the sweep that it is part of.
    std::uint64_t sequence{};
    v1::Kind kind{v1::SWEEP};
    /// Sectors: 0 for the first of a sweep. If 0 comes again under the same sequence, the lidar
    /// began its turn anew: what came before is void.
    std::uint32_t sector{};
    bool last{};  ///< Sectors: the sweep is complete.
    /// Sweeps directly before this one that were left out as wished.
    std::uint32_t omitted{};
    /// Frames directly before this one that should have come and did not, because this client reads
    /// too slowly. Of sectors: at least so many.
    std::uint64_t missed{};
    std::size_t wire_bytes{};  ///< what the frame took on the connection
    frame::DecodedScan scan;
};

/// The gateway has more lidars than a client keeps (256), names of more than 256 bytes, or states
/// of more than 64 kB. The client leaves out what the gateway says of those. This event comes once
/// per connection; Client::left_out() counts on.
struct LeftOut {
    Problem why;
};

/// The lidar's state changed, or it is new: v1::Lidar. What is sent from now on: v1::Subscribed.
/// Frames had to be dropped: v1::StreamStats. A wish is refused: v1::StreamError; what was wished
/// before stays.
using Event = std::variant<
    Connected,
    Disconnected,
    Scan,
    v1::Lidar,
    v1::Subscribed,
    v1::StreamStats,
    v1::StreamError,
    LeftOut>;

}  // namespace sweepcast::client
