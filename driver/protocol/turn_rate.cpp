// How far a scanner turns per packet.
#include "driver/protocol/turn_rate.hpp"

#include <algorithm>
#include <cstdlib>

namespace sweepcast::protocol {
namespace {

bool agree(std::int32_t turned, std::int32_t rate) {
    return rate > 0 && std::abs(turned - rate) <= rate / 16;
}

}  // namespace

std::int32_t TurnRate::learn(std::int32_t turned) {
    if (agree(turned, rate_)) {
        rate_ = turned;
        agreements_ = std::min(agreements_ + 1, 2);
        doubt_ = 0;
        return 1;
    }
    if (steady() && doubt_ == 0) {
        doubt_ = turned;
        return packet_times(turned).value_or(1);
    }
    rate_ = turned;
    agreements_ = agree(turned, doubt_) ? 1 : 0;
    doubt_ = 0;
    return 1;
}

std::optional<std::int32_t> TurnRate::packet_times(std::int32_t turned) const {
    if (!steady() || rate_ <= 0 || turned <= 0) {
        return std::nullopt;
    }
    const auto times = (turned + rate_ / 2) / rate_;
    if (times < 1 || std::abs(turned - times * rate_) > rate_ / 8) {
        return std::nullopt;
    }
    return times;
}

}  // namespace sweepcast::protocol
