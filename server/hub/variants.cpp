#include "server/hub/variants.hpp"

#include <algorithm>

namespace sweepcast::hub {

bool Variants::is_plain(const frame::Wish& wish) {
    const auto& format = wish.format;
    frame::Wish plain;
    plain.kind = wish.kind;
    plain.sector_mdeg = wish.kind == frame::Kind::sector ? frame::usual_sector_mdeg : 0;
    plain.format.compression = format.compression;
    plain.format.dictionary = format.dictionary;
    plain.format.leave_out_flags = format.leave_out_flags && format.leave_out_times;
    plain.format.leave_out_times = plain.format.leave_out_flags;
    return wish == plain;
}

/// Returns whether one more distinct request may be served. The caller holds the lock.
bool Variants::has_room(const VariantPtr& replaced) const {
    const auto taken = std::ranges::count_if(uses_, [&](const Use& use) {
        const bool leaves = use.variant == replaced && use.subscribers == 1;
        return !leaves && !is_plain(use.variant->wish());
    });
    return static_cast<std::size_t>(taken) < most;
}

VariantPtr Variants::acquire(const Wish& wish, const VariantPtr& replaced) {
    const std::lock_guard lock(mutex_);
    auto use = std::ranges::find_if(uses_, [&](const Use& used) {
        return used.variant->wish() == wish.frames;
    });
    if (use == uses_.end()) {
        if (!is_plain(wish.frames) && !has_room(replaced)) {
            return nullptr;
        }
        uses_.push_back({std::make_shared<const Variant>(wish.frames)});
        use = std::prev(uses_.end());
    }
    ++use->subscribers;
    ++subscribers_;
    if (++use->by_lidar[wish.lidar] == 1) {
        ++version_;
    }
    return use->variant;
}

void Variants::release(const VariantPtr& variant, std::optional<std::uint32_t> lidar) {
    const std::lock_guard lock(mutex_);
    const auto use = std::ranges::find(uses_, variant, &Use::variant);
    const auto of_lidar = use->by_lidar.find(lidar);
    if (--of_lidar->second == 0) {
        use->by_lidar.erase(of_lidar);
        ++version_;
    }
    --subscribers_;
    if (--use->subscribers == 0) {
        uses_.erase(use);
    }
}

std::vector<VariantPtr> Variants::wanted(std::uint32_t lidar) const {
    const std::lock_guard lock(mutex_);
    std::vector<VariantPtr> variants;
    for (const auto& use : uses_) {
        if (use.by_lidar.contains(std::nullopt) || use.by_lidar.contains(lidar)) {
            variants.push_back(use.variant);
        }
    }
    return variants;
}

}  // namespace sweepcast::hub
