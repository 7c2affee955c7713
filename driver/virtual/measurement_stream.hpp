// MeasurementStream: the packets of a running scan, one after the other, as the head turns.
#pragma once

#include "driver/virtual/beam.hpp"
#include "driver/virtual/motor.hpp"
#include "driver/virtual/persona.hpp"

#include <cstdint>
#include <vector>

namespace sweepcast::virtual_lidar {

/// Whether the virtual lidar can produce streams of this type.
[[nodiscard]] bool can_stream(protocol::AnswerType type);

/// Measures packet by packet. A packet can be had once the head is past its last sample: where the
/// next packet starts is part of what its samples mean.
class MeasurementStream {
public:
    /// A stream in `mode`, whose answer type can_stream(), with the first sample at `first_sample`.
    /// Throws std::invalid_argument for a type that cannot.
    MeasurementStream(const ScanMode& mode, const Motor& motor, Moment first_sample);

    /// When the packet being measured is complete, and the first sample of the next one is taken.
    [[nodiscard]] Moment packet_end() const;

    /// When the packet being measured is ready to be sent: one and a half sample durations after
    /// its last sample, for half the sample and the filter behind it (protocol.md 8).
    [[nodiscard]] Moment packet_ready() const;

    /// Completes the packet and goes on to the next. Gives its bytes; they are valid until the next
    /// call. `switched_on` is the world's time 0.
    const std::vector<std::uint8_t>& measure(const Motor& motor, Beam& beam, Moment switched_on);

private:
    [[nodiscard]] int samples_per_packet() const;
    void measure_normal(Beam& beam, Moment switched_on);
    void measure_express(Beam& beam, Moment switched_on, double end_turns);

    ScanMode mode_;
    Moment packet_start_;
    double start_turns_{};     // at packet_start_
    double previous_turns_{};  // one packet before, for the first of a revolution
    bool restarted_{true};     // the next capsule is the first
    std::vector<std::uint8_t> bytes_;
};

}  // namespace sweepcast::virtual_lidar
