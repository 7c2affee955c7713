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
    /// Each costs every lidar the encoding of a sweep.
    static constexpr std::size_t most = 64;

    /// One more subscriber with this wish, in the place of one with `replaced` that is released
    /// next, if there is one. Null if that would be too many different ones.
    [[nodiscard]] VariantPtr acquire(const Wish& wish, const VariantPtr& replaced = nullptr);
    /// One subscriber less.
    void release(const VariantPtr& variant, std::optional<std::uint32_t> lidar);

    /// Changes whenever wanted() would for some lidar.
    [[nodiscard]] std::uint64_t version() const { return version_; }
    /// What is wanted of a lidar.
    [[nodiscard]] std::vector<VariantPtr> wanted(std::uint32_t lidar) const;

    /// The one with the most subscribers; null if there is none.
    [[nodiscard]] VariantPtr most_common() const;
    [[nodiscard]] std::uint32_t subscribers() const { return subscribers_; }

private:
    struct Use {
        VariantPtr variant;
        /// Subscribers by the lidar that they want; none: all of them.
        std::map<std::optional<std::uint32_t>, std::uint32_t> by_lidar{};
        std::uint32_t subscribers{};
    };

    mutable std::mutex mutex_;
    std::vector<Use> uses_;
    std::atomic<std::uint64_t> version_{};
    std::atomic<std::uint32_t> subscribers_{};
};

}  // namespace sweepcast::hub
