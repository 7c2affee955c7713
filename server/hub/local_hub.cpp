#include "server/hub/local_hub.hpp"

#include "driver/protocol/reply.hpp"
#include "server/hub/named_lidar.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::hub {

namespace {

/// Puts `value` at place `number` - 1, making room as needed.
template <class T>
void keep(std::vector<T>& list, std::uint32_t number, T value) {
    if (list.size() < number) {
        list.resize(number);
    }
    list[number - 1] = std::move(value);
}

/// The frame of this variant; null if there is none.
const VariantFrame* find_frame(const SweepNews& news, const VariantPtr& variant) {
    const auto found = std::ranges::find(news.frames, variant, &VariantFrame::variant);
    return found != news.frames.end() ? &*found : nullptr;
}

}  // namespace

LocalHub::Subscription::Subscription(LocalHub& hub, Outbox& outbox)
    : hub_(hub)
    , outbox_(outbox)
    , place_(hub.subscriptions_.insert(hub.subscriptions_.end(), this)) {}

LocalHub::Subscription::~Subscription() {
    leave();
    hub_.subscriptions_.erase(place_);
}

bool LocalHub::Subscription::set_wish(
    const std::optional<Wish>& wish,
    const frame::WireMessagePtr& answer
) {
    VariantPtr variant;
    if (wish) {
        variant = hub_.variants_.acquire(*wish, group_ != nullptr ? group_->variant : nullptr);
        if (!variant) {
            return false;
        }
    }
    leave();
    outbox_.discard_frames();
    if (variant) {
        join(std::move(variant), wish->lidar);
    }
    if (answer) {
        outbox_.push_control(answer);
    }
    send_latest();
    return true;
}

void LocalHub::Subscription::join(VariantPtr variant, std::optional<std::uint32_t> lidar) {
    lidar_ = lidar;
    group_ = &hub_.group_of(variant);
    auto& members = group_->members(lidar_);
    seat_ = members.size();
    members.push_back(this);
}

void LocalHub::Subscription::leave() {
    if (group_ == nullptr) {
        return;
    }
    auto& members = group_->members(lidar_);
    members[seat_] = members.back();
    members[seat_]->seat_ = seat_;
    members.pop_back();
    hub_.variants_.release(group_->variant, lidar_);
    if (group_->is_empty()) {
        hub_.groups_.remove_if([this](const Group& group) { return &group == group_; });
    }
    group_ = nullptr;
}

/// For one that has just joined: what the others got before.
void LocalHub::Subscription::send_latest() {
    if (group_ == nullptr || group_->variant->wish().kind != frame::Kind::sweep) {
        return;
    }
    for (const auto& news : hub_.latest_) {
        if (!news.sweep || (lidar_ && *lidar_ != news.lidar)) {
            continue;
        }
        const auto* made = find_frame(news, group_->variant);
        outbox_.push_frame(
            made != nullptr ? made->message
                            : group_->variant->belated_frame(*news.sweep, hub_.encoder_)
        );
    }
}

LocalHub::Members& LocalHub::Group::members(const std::optional<std::uint32_t>& lidar) {
    if (!lidar) {
        return of_all;
    }
    if (of_one.size() < *lidar) {
        of_one.resize(*lidar);
    }
    return of_one[*lidar - 1];
}

bool LocalHub::Group::wants(std::uint32_t lidar) const {
    return !of_all.empty() || (lidar <= of_one.size() && !of_one[lidar - 1].empty());
}

bool LocalHub::Group::is_empty() const {
    return of_all.empty() && std::ranges::all_of(of_one, &Members::empty);
}

void LocalHub::Group::push(std::uint32_t lidar, const frame::WireMessagePtr& message) const {
    for (auto* subscription : of_all) {
        subscription->outbox_.push_frame(message);
    }
    if (lidar <= of_one.size()) {
        for (auto* subscription : of_one[lidar - 1]) {
            subscription->outbox_.push_frame(message);
        }
    }
}

LocalHub::Group& LocalHub::group_of(const VariantPtr& variant) {
    const auto known = std::ranges::find(groups_, variant, &Group::variant);
    return known != groups_.end() ? *known : groups_.emplace_back(Group{variant});
}

const LocalHub::Group* LocalHub::find_group(const VariantPtr& variant) const {
    const auto known = std::ranges::find(groups_, variant, &Group::variant);
    return known != groups_.end() ? &*known : nullptr;
}

void LocalHub::deliver(const SweepNews& news) {
    keep(latest_, news.lidar, news);
    deliver(news.lidar, news.frames);
    deliver_belated(news);
}

void LocalHub::deliver(const SectorNews& news) {
    deliver(news.lidar, news.frames);
}

void LocalHub::deliver(std::uint32_t lidar, const std::vector<VariantFrame>& frames) const {
    for (const auto& made : frames) {
        const auto* group = made.is_new ? find_group(made.variant) : nullptr;
        if (group != nullptr) {
            group->push(lidar, made.message);
        }
    }
}

/// To those who wished for it when the lidar had already begun to make the frames of this sweep.
void LocalHub::deliver_belated(const SweepNews& news) {
    for (const auto& group : groups_) {
        if (news.sweep && group.variant->wish().kind == frame::Kind::sweep &&
            group.wants(news.lidar) && find_frame(news, group.variant) == nullptr) {
            group.push(news.lidar, group.variant->belated_frame(*news.sweep, encoder_));
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

LidarSnapshotPtr LocalHub::find(std::string_view name) const {
    std::vector<LidarNames> names(lidars_.size());
    for (std::size_t i = 0; i < lidars_.size(); ++i) {
        if (lidars_[i]) {
            const auto& info = lidars_[i]->state.info;
            names[i] = {
                lidars_[i]->id,
                info ? protocol::serial_text(info->serial) : std::string(),
                lidars_[i]->port_name};
        }
    }
    const auto found = find_named(names, name).index;
    return found ? lidars_[*found] : nullptr;
}

std::shared_ptr<const device::CapturedSweep> LocalHub::latest_sweep(std::uint32_t number) const {
    return number >= 1 && number <= latest_.size() ? latest_[number - 1].sweep : nullptr;
}

}  // namespace sweepcast::hub
