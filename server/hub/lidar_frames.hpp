// LidarFrames: what is made of one lidar's scans: each variant that somebody wants, once.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "driver/device/sweep_progress.hpp"
#include "server/frame/rate_limit.hpp"
#include "server/frame/sector_cutter.hpp"
#include "server/frame/wish_encoder.hpp"
#include "server/hub/publication.hpp"
#include "server/hub/variants.hpp"

#include <cstdint>
#include <string_view>
#include <vector>

namespace sweepcast::hub {

/// Belongs to the lidar's thread.
class LidarFrames {
public:
    /// Of the lidar with this number. `variants` outlives this.
    LidarFrames(const Variants& variants, std::uint32_t lidar)
        : variants_(variants)
        , lidar_(lidar) {}

    /// Frames of a sweep that is complete, sectors of it included.
    [[nodiscard]] std::vector<VariantFrame> of(const device::CapturedSweep& sweep);

    /// Sectors that are due of the sweep under way; `id` is the lidar's. While nobody wants
    /// sectors this is all but free.
    [[nodiscard]] std::vector<VariantFrame>
    of(std::string_view id, const device::SweepProgress& progress);

private:
    /// One variant's frames of this lidar, one after the other.
    struct Stream {
        explicit Stream(VariantPtr wanted);
        [[nodiscard]] bool has_sectors() const {
            return variant->wish().kind == frame::Kind::sector;
        }

        VariantPtr variant;
        frame::RateLimit limit;
        std::uint32_t omitted{};
        frame::WireMessagePtr latest;
        frame::SectorCutter cutter;
        std::uint32_t next_sector{};
    };

    void look_for_changes();
    [[nodiscard]] VariantFrame sweep_of(Stream& stream, const device::CapturedSweep& sweep);
    [[nodiscard]] VariantFrame
    sector_of(Stream& stream, frame::FrameContent content, const frame::Slice& slice);

    const Variants& variants_;
    std::uint32_t lidar_;
    std::uint64_t version_{};  ///< of `variants_`, as far as `streams_` has it
    std::vector<Stream> streams_;
    bool has_sectors_{};
    frame::WishEncoder encoder_;
};

}  // namespace sweepcast::hub
