// Variants: which wishes are in use, over all workers. What nobody wants is not made.
#pragma once

#include "server/hub/publication.hpp"
#include "server/hub/variant.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

namespace sweepcast::hub {

/// Safe from any thread. Subscribers come and go under a lock; lidars look at a counter.
class Variants {
public:
    /// Distinct requests served at a time, besides the plain ones. Each costs every lidar the
    /// encoding of a sweep.
    static constexpr std::size_t most = 64;

    /// Returns whether the request is plain: every sample, as whole sweeps or as sectors of the
    /// usual size, with or without flags and times (the page takes none), in any compression.
    /// There are twelve. They are always served: distinct requests cannot take their places.
    [[nodiscard]] static bool is_plain(const frame::Wish& wish);

    /// Adds a subscriber with this wish, in the place of one with `replaced` that is released
    /// next, if there is one. Returns null if that would be one distinct request too many.
    [[nodiscard]] VariantPtr acquire(const Wish& wish, const VariantPtr& replaced = nullptr);
    /// One subscriber less.
    void release(const VariantPtr& variant, std::optional<std::uint32_t> lidar);

    /// Changes whenever wanted() would for some lidar.
    [[nodiscard]] std::uint64_t version() const { return version_; }
    /// What is wanted of a lidar.
    [[nodiscard]] std::vector<VariantPtr> wanted(std::uint32_t lidar) const;

    [[nodiscard]] std::uint32_t subscribers() const { return subscribers_; }

private:
    struct Use {
        VariantPtr variant;
        /// Subscribers by the lidar that they want; none: all of them.
        std::map<std::optional<std::uint32_t>, std::uint32_t> by_lidar{};
        std::uint32_t subscribers{};
    };

    [[nodiscard]] bool has_room(const VariantPtr& replaced) const;

    mutable std::mutex mutex_;
    std::vector<Use> uses_;
    std::atomic<std::uint64_t> version_{};
    std::atomic<std::uint32_t> subscribers_{};
};

}  // namespace sweepcast::hub
