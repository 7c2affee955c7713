#include "server/client/sweep_joiner.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace sweepcast::client {

namespace {

/// More than any sweep has; what a hostile gateway may make us keep.
constexpr std::size_t most_samples = 65536;

}  // namespace

bool SweepJoiner::take(Scan scan) {
    if (scan.kind == v1::SWEEP || scan.sector == 0) {
        if (under_way_ && scan.sequence != sweep_.sequence) {
            lose();
        }
        begin(std::move(scan));
        return true;
    }
    const auto sequence = scan.sequence;
    if (under_way_ && go_on(std::move(scan))) {
        return true;
    }
    if (under_way_ || sequence != last_lost_) {  // once a sweep
        lose();
        last_lost_ = sequence;
    }
    return false;
}

void SweepJoiner::begin(Scan scan) {
    sweep_.sequence = scan.sequence;
    ++sweep_.begun;
    sweep_.complete = scan.kind == v1::SWEEP || scan.last;
    sweep_.scan = std::move(scan.scan);
    next_sector_ = 1;
    under_way_ = !sweep_.complete;
}

bool SweepJoiner::go_on(Scan scan) {
    auto& to = sweep_.scan.sweep;
    const auto& more = scan.scan.sweep;
    if (scan.sequence != sweep_.sequence || scan.sector != next_sector_ ||
        to.samples.size() + more.samples.size() > most_samples) {
        return false;
    }
    to.samples.insert(to.samples.end(), more.samples.begin(), more.samples.end());
    to.period = more.period;
    to.losses += more.losses;
    to.time_uncertainty = std::max(to.time_uncertainty, more.time_uncertainty);
    sweep_.scan.without_times |= scan.scan.without_times;
    ++next_sector_;
    sweep_.complete = scan.last;
    under_way_ = !sweep_.complete;
    return true;
}

void SweepJoiner::lose() {
    under_way_ = false;
    ++lost_;
}

}  // namespace sweepcast::client
