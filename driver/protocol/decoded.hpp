// What decoders take and give besides bytes: arrival times, settings, samples and events.
#pragma once

#include "driver/protocol/sample.hpp"
#include "driver/protocol/units.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sweepcast::protocol {

/// When a block of bytes reached the host.
struct Arrival {
    /// The arrival of the block's last byte.
    SampleTime last_byte{};
    /// How much earlier each byte came than the one after it: the time of ten bits on a serial
    /// line, or zero to treat the whole block as arrived at once (as the vendor's SDK does).
    std::chrono::nanoseconds per_byte{};
};

/// What a decoder must know of the line and the mode to time its samples (protocol.md 8).
struct DecodeSettings {
    /// The time from one sample to the next, exactly as the device reports it. Less than a
    /// microsecond: not known.
    std::chrono::nanoseconds sample_duration{};
    /// Line speed in bits per second; 0: the answer type's usual one.
    std::uint32_t baud{};
    /// The line is a network, not a UART: transmission takes a fixed 100 us.
    bool ethernet{};
};

enum class DecodeEventKind : std::uint8_t {
    checksum_error,  ///< a packet was damaged and dropped
    encoder_reset,   ///< a restart came while a capsule was held: that capsule is lost
    scan_reset,     ///< the device restarted its angle reference: the unfinished revolution is void
    bytes_skipped,  ///< `count` bytes belonged to no packet
    /// Besides those with a checksum error, `count` packets that the scanner sent never came, by
    /// how far it had turned meanwhile. Known for capsules only; where a pause or an unsteady speed
    /// hides how far it turned, one, which is given up.
    packets_lost,
};

/// Something that happened between samples.
struct DecodeEvent {
    /// How many samples of `Decoded::samples` had been given out before it.
    std::size_t at_sample{};
    DecodeEventKind kind{};
    std::size_t count{1};
    bool operator==(const DecodeEvent&) const = default;
};

/// The output of a decoder: samples in order, and the events among them.
struct Decoded {
    std::vector<Sample> samples;
    std::vector<DecodeEvent> events;
    /// How far off the samples' times may be (see SampleClock); 0: not known.
    std::chrono::microseconds time_uncertainty{};

    void clear() {
        samples.clear();
        events.clear();
        time_uncertainty = {};
    }
};

}  // namespace sweepcast::protocol
