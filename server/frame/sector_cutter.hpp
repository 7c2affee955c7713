// SectorCutter: the sweep under way -> the slices of it that are sent before it is complete.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "driver/device/sweep_progress.hpp"
#include "server/frame/wish.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace sweepcast::frame {

/// Some samples of a sweep, by their numbers.
struct Slice {
    std::size_t begin{};  ///< 0: the sweep begins here, anew if there were slices of it before
    std::size_t end{};
    bool last{};
    bool operator==(const Slice&) const = default;
};

/// Cuts the sweeps of one lidar for one wish. The slices of a sweep add up to it exactly.
///
/// A slice ends where a packet (rather: what was read at once) ends: at the first such place
/// - at or beyond a multiple of the sector's size, counted from the sweep's first sample; a sample
///   out of line with those around it (noise) does not count, and the end of the turn is no such
///   multiple, as the sweep is about to be complete there;
/// - or where its oldest sample would become older than it may if it waited for one more read.
class SectorCutter {
public:
    /// For a wish whose kind is sector.
    explicit SectorCutter(const Wish& wish);

    /// The slice that is due, if one is.
    std::optional<Slice> cut(const device::SweepProgress& progress);
    /// What is left of a sweep that is complete: all of it, if it is not the one that was under
    /// way. Without samples if all have been cut before.
    Slice finish(const device::CapturedSweep& captured);

private:
    void begin(std::uint64_t begun, std::size_t samples);
    void follow(const protocol::Sample& sample);
    [[nodiscard]] bool is_far_enough() const;
    [[nodiscard]] bool would_wait_too_long(const device::SweepProgress& progress) const;

    std::uint32_t sector_mdeg_;
    std::chrono::microseconds max_latency_;

    std::optional<std::uint64_t> begun_;    ///< the sweep under way
    std::size_t cut_{};                     ///< samples that have been given out
    std::size_t followed_{};                ///< samples that `position_` has taken in
    std::uint16_t angle_{};                 ///< of the last one in line
    std::optional<std::uint16_t> suspect_;  ///< the one after it, out of line
    std::int64_t position_{};               ///< from the first sample, in 1/65536 turn
    std::uint32_t sectors_{};               ///< multiples of the size that lie behind
    std::optional<protocol::SampleTime> last_arrival_;
};

}  // namespace sweepcast::frame
