#include "server/gateway/remote_clock.hpp"

#include <algorithm>

namespace sweepcast::gateway {

namespace {

/// Crystals are within 100 parts in a million, so two clocks drift by at most twice that.
constexpr std::int64_t one_in = 5000;
/// A clock that seems to have gone back by more than this is another one: the machine there was
/// started anew.
constexpr std::chrono::seconds started_anew{10};

}  // namespace

void RemoteClock::hear(protocol::SampleTime there, protocol::SampleTime here) {
    const std::chrono::microseconds seen = here - there;
    if (!offset_ || seen - *offset_ > started_anew) {
        offset_ = seen;
    } else {
        const auto drift = std::max(here - heard_, std::chrono::microseconds(0)) / one_in;
        offset_ = std::min(seen, *offset_ + drift);
    }
    heard_ = here;
}

}  // namespace sweepcast::gateway
