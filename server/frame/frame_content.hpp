// What goes into one frame, and in which form.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "driver/device/sweep_progress.hpp"
#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/sample.hpp"
#include "driver/protocol/sweep.hpp"

#include <chrono>
#include <cstdint>
#include <span>
#include <string_view>

namespace sweepcast::frame {

enum class Kind : std::uint8_t { sweep, sector };

/// A sweep or a slice of one. Refers to what it is made from.
struct FrameContent {
    std::string_view lidar;
    /// Of the sweep, also if this is a slice of it.
    std::uint64_t sequence{};
    Kind kind{Kind::sweep};
    std::uint32_t sector{};   ///< which slice, from 0
    bool last{};              ///< the slice that ends its sweep
    std::uint32_t omitted{};  ///< sweeps left out directly before this one

    std::span<const protocol::Sample> samples;
    std::string_view mode;
    protocol::AnswerType answer_type{protocol::AnswerType::normal};
    /// From one sample to the next, as the lidar reports it.
    std::chrono::nanoseconds sample_duration{};
    /// Add it to a sample's time to get UNIX time.
    std::chrono::nanoseconds monotonic_to_unix{};
    /// How far off the times may be; 0: not known.
    std::chrono::microseconds time_uncertainty{};
    /// By how much the wall clock was set since the scan before; 0: it was not.
    std::chrono::nanoseconds clock_step{};
    /// For how long the lidar was not seen before this sweep; 0: it follows on from the one before.
    std::chrono::nanoseconds gap{};
    /// Of the whole sweep; for a slice, known with the last one.
    std::chrono::microseconds period{};
    protocol::LineLosses losses;
};

/// All of a sweep.
[[nodiscard]] FrameContent whole_sweep(const device::CapturedSweep& captured);

/// All there is so far of one.
[[nodiscard]] FrameContent
sweep_under_way(std::string_view lidar, const device::SweepProgress& progress);

/// What is done to the scan inside a frame.
enum class Compression : std::uint8_t { zstd, none };

/// The form of a frame.
struct FrameFormat {
    Compression compression{Compression::zstd};
    /// Compress with our dictionary, which the client has.
    bool dictionary{};
    /// 0: whatever loses nothing.
    std::uint32_t angle_units_per_turn{};
    /// 0: whatever loses nothing.
    std::uint32_t distance_unit_um{};
    bool leave_out_quality{};
    bool leave_out_flags{};
    bool leave_out_times{};

    bool operator==(const FrameFormat&) const = default;
};

}  // namespace sweepcast::frame
