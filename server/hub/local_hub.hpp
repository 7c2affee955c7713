// LocalHub: one worker's share of the hub. Knows the lidars' latest and delivers to the worker's
// subscribers, without locks.
#pragma once

#include "server/hub/outbox.hpp"
#include "server/hub/publication.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::hub {

/// How many subscribers want each compression, over all workers.
using Demand = std::array<std::atomic<std::uint32_t>, compression_count>;

/// Used on its worker's thread only.
class LocalHub {
public:
    explicit LocalHub(Demand& demand) : demand_(demand) {}
    LocalHub(const LocalHub&) = delete;
    LocalHub& operator=(const LocalHub&) = delete;

    /// A place among the subscribers; leaves it when destroyed. Must not outlive hub or outbox.
    class Subscription {
    public:
        Subscription(LocalHub& hub, Outbox& outbox);
        ~Subscription();
        Subscription(const Subscription&) = delete;
        Subscription& operator=(const Subscription&) = delete;

        /// Sets what to deliver from now on; none: state messages only.
        void set_wish(std::optional<Wish> wish);

    private:
        friend class LocalHub;
        LocalHub& hub_;
        Outbox& outbox_;
        std::optional<Wish> wish_;
        std::list<Subscription*>::iterator place_;
    };

    /// Puts a sweep into the mailbox of everyone who wants it.
    void deliver(const SweepNews& news);
    /// Keeps a lidar's new state and tells every subscriber.
    void deliver(const StateNews& news);
    /// Closes every outbox: the client gets the control messages still waiting, the last of
    /// which is `farewell`.
    void close_all(const frame::WireMessagePtr& farewell, const std::string& reason);

    /// All lidars, by number.
    [[nodiscard]] const std::vector<LidarSnapshotPtr>& lidars() const { return lidars_; }
    /// The lidar with this id or port name, or null.
    [[nodiscard]] LidarSnapshotPtr find(std::string_view id) const;
    /// A lidar's latest sweep, or null.
    [[nodiscard]] std::shared_ptr<const device::CapturedSweep> latest_sweep(std::uint32_t number
    ) const;
    /// Subscribers of all workers that want frames.
    [[nodiscard]] std::uint32_t subscribers() const;

private:
    Demand& demand_;
    std::list<Subscription*> subscriptions_;
    std::vector<LidarSnapshotPtr> lidars_;
    std::vector<std::shared_ptr<const device::CapturedSweep>> latest_;
};

}  // namespace sweepcast::hub
