#include "driver/virtual/damage_count.hpp"

#include "driver/protocol/capsule.hpp"
#include "driver/protocol/crc32.hpp"
#include "driver/protocol/hq_packet.hpp"
#include "driver/protocol/normal_packet.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sweepcast::virtual_lidar {

using protocol::AnswerType;

namespace {

bool intact_hq(std::span<const std::uint8_t> packet) {
    using namespace protocol;
    return packet[0] == hq_sync_byte && load_le32(packet.subspan<hq_checksum_at, 4>()) ==
                                            crc32_padded(packet.first<hq_checksum_at>());
}

}  // namespace

void DamageCount::begin(AnswerType answer) {
    answer_ = answer;
    packet_size_ = protocol::packet_size(answer);
    position_ = 0;
    damaged_ = false;
    gap_ = false;
    window_.clear();
    since_damage_ = packet_size_;
}

void DamageCount::pass(std::uint8_t sent, std::span<const std::uint8_t> arrived) {
    if (packet_size_ == 0) {
        return;
    }
    if (position_ == 0) {
        ++counters_.packets;
        damaged_ = false;
    }
    position_ = (position_ + 1) % packet_size_;
    const bool same = arrived.size() == 1 && arrived.front() == sent;
    if (!same && !std::exchange(damaged_, true)) {
        ++counters_.damaged;
    }
    if (arrived.empty()) {
        gap_ = true;
        return;
    }
    for (std::size_t i = 0; i < arrived.size(); ++i) {
        if (arrived[i] != sent) {
            since_damage_ = 0;  // in this byte
        } else if (gap_ || i > 0) {
            since_damage_ = 1;  // before it: a packet that begins here does not hold it
        }
        gap_ = false;
        take(arrived[i]);
    }
}

void DamageCount::pass_unchanged(std::span<const std::uint8_t> sent) {
    if (packet_size_ == 0) {
        return;
    }
    std::size_t passed = 0;
    while (passed < sent.size() && (gap_ || since_damage_ <= packet_size_)) {
        pass(sent[passed], sent.subspan(passed, 1));
        ++passed;
    }
    const auto rest = sent.subspan(passed);
    if (rest.empty()) {
        return;
    }
    const auto end = position_ + rest.size();
    const auto begun = (end + packet_size_ - 1) / packet_size_ - (position_ != 0 ? 1 : 0);
    counters_.packets += begun;
    damaged_ = damaged_ && begun == 0;
    position_ = end % packet_size_;
    const auto kept = rest.last(std::min(rest.size(), packet_size_));
    make_room(kept.size());
    window_.insert(window_.end(), kept.begin(), kept.end());
}

void DamageCount::insert(std::span<const std::uint8_t> arrived) {
    if (packet_size_ == 0 || arrived.empty()) {
        return;
    }
    if (position_ != 0 && !std::exchange(damaged_, true)) {
        ++counters_.damaged;
    }
    for (const auto byte : arrived) {
        since_damage_ = 0;
        take(byte);
    }
    gap_ = true;
}

void DamageCount::take(std::uint8_t byte) {
    make_room(1);
    window_.push_back(byte);
    ++since_damage_;
    // The damage is in the last packet_size_ bytes if so many or fewer have come from it on.
    if (window_.size() >= packet_size_ && since_damage_ <= packet_size_ && passes()) {
        ++counters_.undetectable;
    }
}

// Moves the bytes that still count together only now and then, so that one costs little.
void DamageCount::make_room(std::size_t count) {
    if (window_.size() + count > 4 * packet_size_) {
        const auto surplus = static_cast<std::ptrdiff_t>(window_.size() - packet_size_);
        window_.erase(window_.begin(), std::next(window_.begin(), surplus));
    }
}

bool DamageCount::passes() const {
    const auto packet = std::span(window_).last(packet_size_);
    switch (answer_) {
    case AnswerType::normal:
        return protocol::is_normal_packet(packet.data());
    case AnswerType::hq:
        return intact_hq(packet);
    default:
        return protocol::intact_capsule(packet);
    }
}

}  // namespace sweepcast::virtual_lidar
