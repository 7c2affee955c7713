// SweepAssembler: samples -> sweeps, one per revolution.
//
// The angle is followed without wrapping: the position is counted on from heading 0 before the
// sweep began, so a revolution is complete when the position has passed heading 0 again, whether or
// not a mark says so.
//
//  state     | event                                | what happens                  | next state
//  ----------+--------------------------------------+-------------------------------+-----------
//  any       | sample out of line (over 1/8 turn    | held back until the next one  | same
//            | away)                                | judges it                     |
//  any       | the next continues what was before   | it was noise: kept, but its   | same
//            | it, or neither (at most 3 in a row)  | angle and mark count nothing  |
//  any       | the next continues it                | the jump was real, forward as | same
//            |                                      | a lidar turns; if searching,  |
//            |                                      | it only says where to go on   |
//  searching | mark, or position passes heading 0   | sweep begins with this sample | gathering
//  searching | other sample                         | dropped                       | searching
//  gathering | mark at least 1/2 turn after the     | sweep given out, next one     | gathering
//            | beginning                            | begins                        |
//  gathering | position passes the first heading 0  | the same: the mark was lost   | gathering
//            | at least 1/2 turn after it           |                               |
//  gathering | other sample, marked or not          | added to the sweep            | gathering
//  gathering | more samples than a sweep can have   | sweep dropped, its samples    | overgrown
//            |                                      | counted                       |
//  overgrown | a beginning as under gathering       | sweep begins with this sample | gathering
//  overgrown | other sample                         | dropped and counted           | overgrown
//  any       | scan_reset                           | unfinished sweep dropped and  | searching
//            |                                      | counted                       |
//
// The half turn makes a mark shortly before heading 0 (0x82 marks the last sample before raw 360
// degrees, and its corrected angles go back and forth over 0) and the passing of heading 0 itself
// count as one.
#pragma once

#include "driver/protocol/decoded.hpp"
#include "driver/protocol/sweep.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace sweepcast::protocol {

/// The most samples a revolution may have: twice what the fastest scanner takes at its slowest
/// turn.
inline constexpr std::size_t max_sweep_samples = 16384;

/// Cuts the samples of a stream into revolutions.
class SweepAssembler {
public:
    /// Appends to `finished` every sweep that `decoded` completes.
    void push(const Decoded& decoded, std::vector<Sweep>& finished);

    /// The revolution under way, as far as the samples pushed are sure to belong to it; empty while
    /// there is none. Valid until the next push().
    [[nodiscard]] UnfinishedSweep unfinished() const { return {samples_, begun_, uncertainty_}; }

    /// Takes back a sweep that is no longer needed, to use its memory again.
    void recycle(Sweep&& spent);

private:
    enum class State { searching, gathering, overgrown };

    void apply(const DecodeEvent& event);
    void restart();
    void take(const Sample& sample, std::vector<Sweep>& finished);
    void judge_suspect(const Sample& next, std::vector<Sweep>& finished);
    void follow(const Sample& sample, std::int64_t advance, std::vector<Sweep>& finished);
    void start_following(const Sample& sample);
    [[nodiscard]] bool begins_sweep(const Sample& sample) const;
    void finish_sweep(const Sample& next, std::vector<Sweep>& finished);
    void begin_sweep();
    void add(const Sample& sample);
    void discard(std::size_t count) { losses_.discarded_samples += count; }

    State state_{State::searching};
    std::optional<std::uint16_t> angle_;  ///< of the last sample in line
    std::optional<Sample> suspect_;       ///< a sample out of line, held back
    int undecided_{};                  ///< suspects in a row that the next sample did not explain
    std::int64_t position_{};          ///< of the last sample in line, in 1/65536 turn
    std::int64_t mark_counts_from_{};  ///< the position from which a mark begins a sweep
    std::int64_t next_zero_{};         ///< the position of the heading 0 that begins a sweep
    std::vector<Sample> samples_;      ///< of the sweep being gathered
    std::vector<Sample> spare_;        ///< memory of a spent sweep
    std::uint64_t begun_{};            ///< sweeps
    std::chrono::microseconds pushed_uncertainty_{};  ///< of the samples being pushed
    std::chrono::microseconds uncertainty_{};         ///< of those gathered
    LineLosses losses_;
};

}  // namespace sweepcast::protocol
