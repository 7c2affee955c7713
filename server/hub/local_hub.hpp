// LocalHub: one worker's share of the hub. Knows the lidars' latest and delivers to the worker's
// subscribers, without locks.
#pragma once

#include "server/frame/wish_encoder.hpp"
#include "server/hub/outbox.hpp"
#include "server/hub/publication.hpp"
#include "server/hub/variants.hpp"

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::hub {

/// Used on its worker's thread only.
class LocalHub {
    struct Group;

public:
    /// `variants`, which all workers share, outlives this.
    explicit LocalHub(Variants& variants) : variants_(variants) {}
    ~LocalHub() = default;
    LocalHub(const LocalHub&) = delete;
    LocalHub& operator=(const LocalHub&) = delete;

    /// A place among the subscribers; leaves it when destroyed. Must not outlive hub or outbox.
    class Subscription {
    public:
        Subscription(LocalHub& hub, Outbox& outbox);
        ~Subscription();
        Subscription(const Subscription&) = delete;
        Subscription& operator=(const Subscription&) = delete;

        /// Sets what to deliver from now on; none: state messages only. Frames of the wish before
        /// that still wait are forgotten, then come `answer`, if there is one, and the latest sweep
        /// of each lidar wanted, if sweeps are.
        /// Returns false, and changes nothing, if there are too many distinct requests already.
        [[nodiscard]] bool
        set_wish(const std::optional<Wish>& wish, const frame::WireMessagePtr& answer = nullptr);

    private:
        friend class LocalHub;
        void join(VariantPtr variant, std::optional<std::uint32_t> lidar);
        void leave();
        void send_latest();

        LocalHub& hub_;
        Outbox& outbox_;
        std::optional<std::uint32_t> lidar_;  ///< the one that is wanted; none: all
        Group* group_{};                      ///< of those who want the same; null: no frames
        std::size_t seat_{};                  ///< among those of the group who want the same lidar
        std::list<Subscription*>::iterator place_;
    };

    /// Gives a sweep to everyone who wants it.
    void deliver(const SweepNews& news);
    /// Gives sectors to everyone who wants them.
    void deliver(const SectorNews& news);
    /// Keeps a lidar's new state and tells every subscriber.
    void deliver(const StateNews& news);
    /// Closes every outbox: the client gets the control messages still waiting, the last of
    /// which is `farewell`.
    void close_all(const frame::WireMessagePtr& farewell, const std::string& reason);

    /// All lidars, by number.
    [[nodiscard]] const std::vector<LidarSnapshotPtr>& lidars() const { return lidars_; }
    /// Returns the lidar that this name means (see find_named), or null.
    [[nodiscard]] LidarSnapshotPtr find(std::string_view name) const;
    /// A lidar's latest sweep, or null.
    [[nodiscard]] std::shared_ptr<const device::CapturedSweep> latest_sweep(std::uint32_t number
    ) const;
    /// Subscribers of all workers that want frames.
    [[nodiscard]] std::uint32_t subscribers() const { return variants_.subscribers(); }

private:
    using Members = std::vector<Subscription*>;

    /// The subscribers that share a variant.
    struct Group {
        VariantPtr variant;
        Members of_all{};               ///< who want all lidars
        std::vector<Members> of_one{};  ///< who want one, by its number - 1

        Members& members(const std::optional<std::uint32_t>& lidar);
        [[nodiscard]] bool wants(std::uint32_t lidar) const;
        [[nodiscard]] bool is_empty() const;
        void push(std::uint32_t lidar, const frame::WireMessagePtr& message) const;
    };

    Group& group_of(const VariantPtr& variant);
    [[nodiscard]] const Group* find_group(const VariantPtr& variant) const;
    void deliver(std::uint32_t lidar, const std::vector<VariantFrame>& frames) const;
    void deliver_belated(const SweepNews& news);

    Variants& variants_;
    std::list<Subscription*> subscriptions_;
    std::list<Group> groups_;
    std::vector<LidarSnapshotPtr> lidars_;
    std::vector<SweepNews> latest_;
    frame::WishEncoder encoder_;  ///< for who comes late
};

}  // namespace sweepcast::hub
