#include "server/hub/variants.hpp"

#include <algorithm>

namespace sweepcast::hub {

VariantPtr Variants::acquire(const Wish& wish, const VariantPtr& replaced) {
    const std::lock_guard lock(mutex_);
    auto use = std::ranges::find_if(uses_, [&](const Use& used) {
        return used.variant->wish() == wish.frames;
    });
    if (use == uses_.end()) {
        const auto leaving = std::ranges::find(uses_, replaced, &Use::variant);
        const bool makes_room = leaving != uses_.end() && leaving->subscribers == 1;
        if (uses_.size() >= most + (makes_room ? 1 : 0)) {
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

VariantPtr Variants::most_common() const {
    const std::lock_guard lock(mutex_);
    const auto use = std::ranges::max_element(uses_, {}, &Use::subscribers);
    return use != uses_.end() ? use->variant : nullptr;
}

}  // namespace sweepcast::hub
