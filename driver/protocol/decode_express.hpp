// Bytes of answer type 0x82 (express) -> samples.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/backlog.hpp"
#include "driver/protocol/capsule.hpp"
#include "driver/protocol/decoded.hpp"
#include "driver/protocol/sample_timing.hpp"
#include "driver/protocol/turn_rate.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace sweepcast::protocol {

/// Decodes express capsules: 84 bytes, 32 samples. A capsule's angles reach up to the next one's
/// start angle, so its samples come out when the next capsule is in. Source:
/// protocol.md 7.2, 7.3, 8.
///
/// An undamaged stream gives bit for bit what the vendor's decoder gives. After damage it recovers
/// more:
///  - the bytes of a damaged capsule are searched for the beginning of another one;
///  - out of step, a capsule counts if it is intact and either lies a whole number of capsules
///  after the
///    last good one or is followed at once by another intact one: sync nibbles and an 8-bit
///    checksum alone would pass one piece of noise in 65536;
///  - the capsule before the damage is decoded if the turn up to the next good one fits a whole
///  number of
///    packets at the steady rate; its angles then cover its own share of that turn. More than one
///    packet is believed only if a capsule's sync nibbles followed it directly, else its own tail
///    may be missing;
///  - a packet lost without a trace shows as a sudden multiple of the steady rate and is treated
///  likewise,
///    where the vendor stretches the capsule before it over the gap.
class ExpressDecoder {
public:
    explicit ExpressDecoder(const DecodeSettings& settings);

    /// Appends to `out` what `bytes` complete.
    void push(std::span<const std::uint8_t> bytes, const Arrival& arrival, Decoded& out);

private:
    static constexpr std::size_t capsule_size = packet_size(AnswerType::express);
    using CapsuleBytes = std::span<const std::uint8_t, capsule_size>;

    struct Held {
        std::array<std::uint8_t, capsule_size> bytes{};
        StartWord start;
        SampleTime arrival{};
    };

    /// What is known of the bytes since the last good capsule.
    struct Damage {
        std::size_t bytes{};       ///< given up so far
        std::size_t unreported{};  ///< of those, not yet in an event
        bool sync_followed{};      ///< the last good capsule was followed by sync nibbles
    };

    std::size_t step(const TimedBytes& input, Decoded& out);
    std::size_t search(std::span<const std::uint8_t> bytes, Decoded& out);
    void lose_step(CapsuleBytes bytes, Decoded& out);
    void give_up(std::size_t count, Decoded& out);
    void report_skipped(Decoded& out);
    void accept(CapsuleBytes bytes, SampleTime arrival, Decoded& out);
    void finish_held(StartWord next, Decoded& out);
    void decode_held(std::int32_t turned_q8, Decoded& out) const;

    SampleTiming timing_;
    Backlog<2 * capsule_size> backlog_;
    TurnRate rate_;
    std::optional<Held> held_;
    std::optional<Damage> damage_;
};

}  // namespace sweepcast::protocol
