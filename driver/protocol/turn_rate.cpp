// How far a scanner turns per packet.
#include "driver/protocol/turn_rate.hpp"

#include <algorithm>
#include <cstdlib>

namespace sweepcast::protocol {
namespace {

bool agree(std::int32_t turned, std::int32_t rate) {
    return rate > 0 && std::abs(turned - rate) <= rate / 16;
}

/// The nearest whole number of packets that such a turn takes at `rate` a packet.
std::optional<std::int32_t> whole_packets(std::int32_t turned, std::int32_t rate) {
    if (rate <= 0 || turned <= 0) {
        return std::nullopt;
    }
    const auto times = (turned + rate / 2) / rate;
    if (times < 1 || std::abs(turned - times * rate) > rate / 8) {
        return std::nullopt;
    }
    return times;
}

}  // namespace

std::optional<std::int32_t> TurnRate::learn(std::int32_t turned) {
    if (agree(turned, rate_)) {
        rate_ = turned;
        agreements_ = std::min(agreements_ + 1, 2);
        doubt_ = 0;
        return steady() ? std::optional(1) : std::nullopt;
    }
    if (steady() && doubt_ == 0) {
        doubt_ = turned;
        return packet_times(turned);
    }
    rate_ = turned;
    agreements_ = agree(turned, doubt_) ? 1 : 0;
    doubt_ = 0;
    return std::nullopt;
}

std::optional<std::int32_t> TurnRate::packet_times(std::int32_t turned) const {
    return steady() ? whole_packets(turned, rate_) : std::nullopt;
}

std::optional<std::int32_t> common_rate(std::int32_t turned, std::int32_t then) {
    return agree(turned, then) ? std::optional(then) : std::nullopt;
}

std::optional<std::int32_t> packet_times_at(std::int32_t rate, std::int32_t turned) {
    return turned <= rate + rate / 4 ? 1 : whole_packets(turned, rate);
}

}  // namespace sweepcast::protocol
