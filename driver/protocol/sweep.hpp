// Sweep: one revolution of samples, complete or under way, and what the line lost meanwhile.
#pragma once

#include "driver/protocol/decoded.hpp"
#include "driver/protocol/sample.hpp"

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::protocol {

/// Counts of what was lost before decoding.
struct LineLosses {
    std::uint64_t checksum_errors{};
    std::uint64_t skipped_bytes{};
    /// Samples of a revolution that was given up: the one under way at a restart of the angle
    /// reference, or one that grew beyond any plausible size.
    std::uint64_t discarded_samples{};
    /// Packets that never came, as far as the angles tell (DecodeEventKind::packets_lost).
    std::uint64_t lost_packets{};

    /// Adds the damage that a decoder tells of; restarts are none.
    void count(const DecodeEvent& event) {
        switch (event.kind) {
        case DecodeEventKind::checksum_error:
            checksum_errors += event.count;
            break;
        case DecodeEventKind::bytes_skipped:
            skipped_bytes += event.count;
            break;
        case DecodeEventKind::packets_lost:
            lost_packets += event.count;
            break;
        case DecodeEventKind::encoder_reset:
        case DecodeEventKind::scan_reset:
            break;
        }
    }

    LineLosses& operator+=(const LineLosses& other) {
        checksum_errors += other.checksum_errors;
        skipped_bytes += other.skipped_bytes;
        discarded_samples += other.discarded_samples;
        lost_packets += other.lost_packets;
        return *this;
    }
    bool operator==(const LineLosses&) const = default;
};

/// One revolution, its samples in the order they were measured.
struct Sweep {
    std::vector<Sample> samples;
    /// From the first sample of this sweep to the first of the next: one turn.
    std::chrono::microseconds period{};
    /// What was lost since the previous sweep was given out.
    LineLosses losses;
    /// Counts the sweeps begun in the stream from 1, also those that were given up.
    std::uint64_t begun{};
    /// How far off the samples' times may be (see SampleClock); 0: not known.
    std::chrono::microseconds time_uncertainty{};

    /// Turns per second; 0 if the period is not known.
    [[nodiscard]] double rotation_hz() const {
        return period.count() > 0 ? 1e6 / static_cast<double>(period.count()) : 0.0;
    }
    bool operator==(const Sweep&) const = default;
};

/// The revolution under way. Its samples only grow until it is complete, and are then the first of
/// the Sweep with the same `begun`; if another number begins instead, it was given up.
struct UnfinishedSweep {
    std::span<const Sample> samples;
    std::uint64_t begun{};
    std::chrono::microseconds time_uncertainty{};  ///< of the samples so far
};

}  // namespace sweepcast::protocol
