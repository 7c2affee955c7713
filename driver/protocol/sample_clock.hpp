// SampleClock: gives samples times that do not depend on how late the line delivered them.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/arrival_envelope.hpp"
#include "driver/protocol/decoded.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace sweepcast::protocol {

/// What must be known of a stream to time its samples.
struct SampleClockSettings {
    AnswerType type{};
    /// From one sample to the next, as exactly as the lidar tells it; 0: it does not.
    std::chrono::nanoseconds sample_duration{};
    /// A byte on the line; 0: a network, whose packets come as a whole.
    std::chrono::nanoseconds per_byte{};
};

/// A decoder reckons the time of a sample back from the arrival of its packet. USB adapters deliver
/// in bursts (latency up to 16 ms, protocol.md 13.20), operating systems when they get round to it:
/// such times jitter by that much, and go backwards where a block ends. This takes them as points,
/// (samples taken so far, time), finds the line under them, and puts the samples on it. What comes
/// out advances always, in straight pieces as long as they can be, and nothing waits for later
/// arrivals.
///
/// `Decoded::time_uncertainty` tells how far off it may be: what the points scatter above the line,
/// what a reader that polls can not see (the time between two packets on the line), and after the
/// start or damage, what is not yet known. A delay that all packets have alike shows nowhere.
class SampleClock {
public:
    explicit SampleClock(const SampleClockSettings& settings);

    /// Gives the samples of `decoded` their times: all that `bytes` bytes have completed, which
    /// arrived then, as the decoder gave them.
    void retime(Decoded& decoded, std::size_t bytes, SampleTime arrival);

private:
    /// How the line delivers, in the last seconds and in those before.
    struct Delivery {
        std::size_t greatest_read{};
        std::size_t cut_reads{};  ///< that ended within a packet, or brought several
    };

    void note_read(std::size_t bytes, double now);
    void note_damage(const DecodeEvent& event, double now);
    void observe(const Decoded& decoded, double now);
    void observe_packet(const Sample& last, double now);
    void notice_pause(double now);
    void assign(Decoded& decoded);
    void aim(double count);
    [[nodiscard]] double drawn(double count) const;
    [[nodiscard]] double unseen_delay() const;
    [[nodiscard]] double uncertainty(double now) const;
    [[nodiscard]] double packet_time() const;
    [[nodiscard]] double since_start(SampleTime time) const;

    std::size_t samples_per_packet_;
    bool holds_packet_;  ///< the decoder gives out no packet before the next one is in
    double packet_bytes_;
    double nominal_step_;
    double per_byte_;
    double sending_;  ///< what a decoder does not subtract of a packet's time on the line
    ArrivalEnvelope envelope_;

    bool started_{};
    SampleTime start_{};
    double count_{};       ///< samples taken by the scanner, also those lost on the way
    double lost_after_{};  ///< samples lost after the packet that a decoder still holds
    double last_above_{};  ///< how far the latest packet was above the line
    std::optional<double> late_since_;  ///< packets are later than any delay
    std::vector<double> counts_;        ///< at the first sample of each packet in hand
    std::uint64_t bytes_{};
    Delivery lately_;
    Delivery before_;
    double epoch_ends_{};
    double doubt_{};  ///< about the count, as time
    double doubt_ends_{};

    // The line that is given out: from a corner on in one direction, and later in another.
    bool drawing_{};
    double corner_count_{};
    double corner_time_{};
    double step_{};
    double bend_count_{};  ///< from here on next_step_
    double next_step_{};
    double off_{};  ///< how far it is from the envelope
};

}  // namespace sweepcast::protocol
