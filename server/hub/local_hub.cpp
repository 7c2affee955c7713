#include "server/hub/local_hub.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::hub {

namespace {

std::atomic<std::uint32_t>& counter(Demand& demand, const Wish& wish) {
    return demand[static_cast<std::size_t>(wish.compression)];
}

/// Puts `value` at place `number` - 1, making room as needed.
template <class T>
void keep(std::vector<T>& list, std::uint32_t number, T value) {
    if (list.size() < number) {
        list.resize(number);
    }
    list[number - 1] = std::move(value);
}

}  // namespace

LocalHub::Subscription::Subscription(LocalHub& hub, Outbox& outbox)
    : hub_(hub)
    , outbox_(outbox)
    , place_(hub.subscriptions_.insert(hub.subscriptions_.end(), this)) {}

LocalHub::Subscription::~Subscription() {
    set_wish(std::nullopt);
    hub_.subscriptions_.erase(place_);
}

void LocalHub::Subscription::set_wish(std::optional<Wish> wish) {
    if (wish_) {
        --counter(hub_.demand_, *wish_);
    }
    wish_ = wish;
    if (wish_) {
        ++counter(hub_.demand_, *wish_);
    }
}

void LocalHub::deliver(const SweepNews& news) {
    keep(latest_, news.lidar, news.sweep);
    for (auto* subscription : subscriptions_) {
        const auto& wish = subscription->wish_;
        if (!wish || (wish->lidar && *wish->lidar != news.lidar)) {
            continue;
        }
        // Null for one who subscribed after the sweep had been encoded: the next one will be there.
        if (const auto& frame = news.frames[static_cast<std::size_t>(wish->compression)]) {
            subscription->outbox_.push_frame(frame);
        }
    }
}

void LocalHub::deliver(const StateNews& news) {
    keep(lidars_, news.lidar->number, news.lidar);
    for (auto* subscription : subscriptions_) {
        subscription->outbox_.push_control(news.message);
    }
}

void LocalHub::close_all(const frame::WireMessagePtr& farewell, const std::string& reason) {
    for (auto* subscription : subscriptions_) {
        subscription->outbox_.push_control(farewell);
        subscription->outbox_.close(reason);
    }
}

LidarSnapshotPtr LocalHub::find(std::string_view id) const {
    const auto by_id =
        std::ranges::find_if(lidars_, [&](const auto& lidar) { return lidar && lidar->id == id; });
    if (by_id != lidars_.end()) {
        return *by_id;
    }
    const auto by_port = std::ranges::find_if(lidars_, [&](const auto& lidar) {
        return lidar && lidar->port_name == id;
    });
    return by_port != lidars_.end() ? *by_port : nullptr;
}

std::shared_ptr<const device::CapturedSweep> LocalHub::latest_sweep(std::uint32_t number) const {
    return number >= 1 && number <= latest_.size() ? latest_[number - 1] : nullptr;
}

std::uint32_t LocalHub::subscribers() const {
    std::uint32_t all = 0;
    for (const auto& count : demand_) {
        all += count.load(std::memory_order_relaxed);
    }
    return all;
}

}  // namespace sweepcast::hub
