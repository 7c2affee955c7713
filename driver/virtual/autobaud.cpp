#include "driver/virtual/autobaud.hpp"

#include "driver/protocol/request.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>

namespace sweepcast::virtual_lidar {

namespace {

using namespace std::chrono_literals;

// Two of the blocks that the vendor's SDK sends. Nothing tells how many a scanner needs, nor how
// long it waits for the confirmation.
constexpr int needed_run = 32;
constexpr auto trial_time = 2000ms;

// "More than about 100 bytes a second": a run that pauses for longer than a block of sixteen takes
// at that rate has ended.
constexpr auto longest_pause = 160ms;

constexpr std::uint32_t slowest_baud = 9'600;
constexpr std::uint32_t fastest_baud = 1'000'000;

}  // namespace

Autobaud::Autobaud(std::uint32_t usual_baud) : usual_baud_(usual_baud), baud_(usual_baud) {}

std::optional<std::uint32_t>
Autobaud::push(std::span<const std::uint8_t> bytes, std::uint32_t host_baud, Moment now) {
    if (now - run_grew_ > longest_pause) {
        run_ = 0;
    }
    run_grew_ = now;
    for (const auto byte : bytes) {
        run_ = byte == protocol::autobaud_byte ? std::min(run_ + 1, needed_run) : 0;
    }
    const bool possible = host_baud >= slowest_baud && host_baud <= fastest_baud;
    if (run_ < needed_run || trial_ || !possible) {
        return std::nullopt;
    }
    run_ = 0;
    trial_ = {.old_baud = baud_, .ends = now + trial_time};
    baud_ = host_baud;
    return host_baud;
}

void Autobaud::confirm(std::span<const std::uint8_t> payload) {
    constexpr std::size_t payload_size = 8;
    constexpr std::uint16_t flag = 0x5F5F;
    if (!trial_ || payload.size() < payload_size ||
        protocol::load_le16(payload.first<2>()) != flag) {
        return;
    }
    const std::uint64_t wanted = protocol::load_le32(payload.subspan<2, 4>());
    if (wanted * 100U > baud_ * 95ULL && wanted * 100U < baud_ * 105ULL) {
        baud_ = static_cast<std::uint32_t>(wanted);
        trial_.reset();
    }
}

void Autobaud::advance(Moment now) {
    if (trial_ && trial_->ends <= now) {
        baud_ = trial_->old_baud;
        trial_.reset();
    }
}

std::optional<Moment> Autobaud::trial_ends() const {
    return trial_ ? std::optional(trial_->ends) : std::nullopt;
}

void Autobaud::reset() {
    baud_ = usual_baud_;
    trial_.reset();
    run_ = 0;
}

}  // namespace sweepcast::virtual_lidar
