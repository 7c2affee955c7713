// MissedFrames: tells from the numbers of a lidar's frames how many did not come.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace sweepcast::v1 {
class Frame;
}

namespace sweepcast::client {

/// Of one connection, and one wish: a count begins with Subscribed. Sweeps: gap - omitted. Sectors:
/// at least so many, for how many a sweep has is not known: those between two of a sweep, one for
/// an end that did not come, those before the first that came of the next, and one for each sweep
/// of which nothing came.
class MissedFrames {
public:
    /// Returns how many frames are missing directly before this one. None if the frame is of a
    /// lidar too many, or has a name too long: it is left out.
    std::optional<std::uint64_t> before(const v1::Frame& frame);

private:
    struct Last {
        std::uint64_t sequence{};
        std::uint32_t sector{};
        bool complete{};
    };
    std::map<std::string, Last> last_;
};

}  // namespace sweepcast::client
