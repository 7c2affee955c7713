// MeasurementStream: the packets of a running scan, one after the other, as the head turns.
#pragma once

#include "driver/virtual/beam.hpp"
#include "driver/virtual/motor.hpp"
#include "driver/virtual/packer.hpp"
#include "driver/virtual/persona.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace sweepcast::virtual_lidar {

/// Walks along time and angle, packet by packet. A packet can be had once the head is past its last
/// sample: where the next packet starts is part of what its samples mean.
class MeasurementStream {
public:
    /// A stream in `mode` with the first sample at `first_sample`.
    MeasurementStream(const ScanMode& mode, const Motor& motor, Moment first_sample);

    /// When the packet being measured is complete, and the first sample of the next one is taken.
    [[nodiscard]] Moment packet_end() const;

    /// When the packet being measured is ready to be sent: one and a half sample durations after
    /// its last sample, for half the sample and the filter behind it (protocol.md 8).
    [[nodiscard]] Moment packet_ready() const;

    /// Completes the packet and goes on to the next. Gives its bytes; they are valid until the next
    /// call. `switched_on` is the world's time 0.
    const std::vector<std::uint8_t>& measure(const Motor& motor, Beam& beam, Moment switched_on);

    /// The angle reference is found anew: the next packet says so.
    void restart_angle();

private:
    ScanMode mode_;
    std::unique_ptr<Packer> packer_;
    Moment packet_start_;
    double start_turns_{};   // at packet_start_
    double turns_before_{};  // at the last sample before
    bool restarted_{true};   // the next packet is the first
};

}  // namespace sweepcast::virtual_lidar
