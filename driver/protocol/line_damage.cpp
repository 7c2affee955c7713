// Counting skipped bytes, each once.
#include "driver/protocol/line_damage.hpp"

#include <algorithm>

namespace sweepcast::protocol {
namespace {

/// Skipped bytes are reported at the latest when this many have gathered, so that a stream of
/// nothing but noise shows.
constexpr std::size_t report_after = 1024;

}  // namespace

LineDamage::LineDamage(std::size_t packet_size, bool sync_followed, Decoded& out)
    : accounted_for_(sync_followed ? packet_size : 0) {
    if (sync_followed) {
        out.events.push_back({out.samples.size(), DecodeEventKind::checksum_error});
    }
}

void LineDamage::give_up(std::size_t count, Decoded& out) {
    const auto before = std::max(given_up_, accounted_for_);
    given_up_ += count;
    unreported_ += std::max(given_up_, accounted_for_) - before;
    if (unreported_ >= report_after) {
        report_skipped(out);
    }
}

void LineDamage::report_skipped(Decoded& out) {
    if (unreported_ > 0) {
        out.events.push_back({out.samples.size(), DecodeEventKind::bytes_skipped, unreported_});
        unreported_ = 0;
    }
}

}  // namespace sweepcast::protocol
