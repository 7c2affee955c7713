// CapsuleDecoder: what the four capsule streams (0x82, 0x84, 0x85, 0x86) have in common: finding
// capsules, holding each until the next is in, judging what happened in between.
#pragma once

#include "driver/protocol/backlog.hpp"
#include "driver/protocol/capsule.hpp"
#include "driver/protocol/decoded.hpp"
#include "driver/protocol/line_damage.hpp"
#include "driver/protocol/sample_timing.hpp"
#include "driver/protocol/turn_rate.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

namespace sweepcast::protocol {

/// A capsule that can be decoded, since the one after it is known.
template <std::size_t Size>
struct FinishedCapsule {
    std::span<const std::uint8_t, Size> bytes;
    /// The next one that came in.
    std::span<const std::uint8_t, Size> next;
    /// No capsule is missing between the two.
    bool next_follows{};
    AngleQ6 start;
    std::int32_t turned_q8{};  ///< during this capsule; negative only if it starts beyond 360
    SampleTime first_sample;
    std::chrono::microseconds sample_duration{};
};

/// Decodes a stream of capsules. A capsule's angles reach up to the next one's start angle, so its
/// samples come out when the next capsule is in. Source: protocol.md 7.2, 8.
///
/// An undamaged stream gives bit for bit what the vendor's decoder gives. After damage this one
/// recovers more:
///  - the bytes of a damaged capsule are searched for the beginning of another one;
///  - out of step, a capsule counts if it is intact and either lies a whole number of capsules
///    after the last good one or is followed at once by another intact one: sync nibbles and an
///    8-bit checksum alone would pass one piece of noise in 65536;
///  - the capsule before the damage is decoded if the turn up to the next good one fits a whole
///    number of packets at the steady rate; its angles then cover its own share of that turn. More
///    than one packet is believed only if a capsule's sync nibbles followed it directly, else its
///    own tail may be missing;
///  - a packet lost without a trace shows as a sudden multiple of the steady rate and is treated
///    likewise, where the vendor stretches the capsule before it over the gap;
///  - after a pause in which the scanner may have turned by half a turn or more, or before which
///    the rate was not steady (if the pause is longer than hosts and adapters are late), nobody
///    knows how far it turned: the capsule before the pause is given up. Bytes that a line
///    delivers late have the times at which it could have had them, so they make no pause; those
///    of a network may. It is none either if the capsule before came after one at least half as
///    long: then the scanner is slower than it says.
///
/// `Format` says what the bytes of an answer type mean:
///  - `type`, `samples_per_capsule`, `start_word_at`;
///  - `greatest_turn_q8(sample_duration)`: a capsule that turns by more is not decoded;
///  - `decode(const FinishedCapsule&, Sample*)` writes all its samples;
///  - `restart()`: nothing from before counts any more.
template <class Format>
class CapsuleDecoder {
public:
    explicit CapsuleDecoder(const DecodeSettings& settings)
        : timing_(Format::type, settings)
        , greatest_turn_q8_(Format::greatest_turn_q8(timing_.sample_duration())) {}

    /// Appends to `out` what `bytes` complete.
    void push(std::span<const std::uint8_t> bytes, const Arrival& arrival, Decoded& out) {
        backlog_.feed(bytes, arrival, [&](const TimedBytes& input) { return step(input, out); });
    }

private:
    static constexpr std::size_t capsule_size = packet_size(Format::type);
    using CapsuleBytes = std::span<const std::uint8_t, capsule_size>;

    struct Held {
        std::array<std::uint8_t, capsule_size> bytes{};
        AngleQ6 start;
        SampleTime arrival{};
    };

    std::size_t step(const TimedBytes& input, Decoded& out);
    std::size_t search(CapsuleBytes bytes, Decoded& out);
    void accept(CapsuleBytes bytes, SampleTime arrival, Decoded& out);
    void restart(Decoded& out);
    void finish_held(CapsuleBytes next, AngleQ6 next_start, SampleTime arrival, Decoded& out);
    [[nodiscard]] std::chrono::microseconds packet_time() const {
        return timing_.sample_duration() * std::int64_t{Format::samples_per_capsule};
    }
    [[nodiscard]] std::int64_t pause_before(SampleTime arrival) const;
    [[nodiscard]] bool hides_turns(std::int64_t pause, std::int32_t turned) const;
    void decode_held(std::int32_t turned_q8, CapsuleBytes next, bool next_follows, Decoded& out);

    SampleTiming timing_;
    std::int32_t greatest_turn_q8_;
    Format format_;
    Backlog<2 * capsule_size> backlog_;
    TurnRate rate_;
    std::optional<Held> held_;
    std::optional<LineDamage> damage_;
    std::int64_t paused_{};  ///< for how many packets, before the capsule held
};

/// Deals with the capsule or the noise at the front of `input`.
template <class Format>
std::size_t CapsuleDecoder<Format>::step(const TimedBytes& input, Decoded& out) {
    const auto bytes = input.bytes();
    if (bytes.size() < capsule_size) {
        return 0;
    }
    const auto capsule = bytes.template first<capsule_size>();
    const bool intact = intact_capsule(capsule);
    if (!intact) {
        if (!damage_) {
            damage_.emplace(capsule_size, opens_capsule(bytes[0], bytes[1]), out);
        }
        return search(capsule, out);
    }
    if (damage_ && damage_->given_up() % capsule_size != 0) {
        if (bytes.size() < 2 * capsule_size) {
            return 0;
        }
        if (!intact_capsule(bytes.template subspan<capsule_size, capsule_size>())) {
            damage_->give_up(1, out);
            return 1;
        }
    }
    accept(capsule, input.arrival_of(capsule_size - 1), out);
    return capsule_size;
}

/// Gives up the bytes before the next place where a capsule may begin; at least one. Looks no
/// further than a capsule's length, so that what is reported does not depend on what else is there.
template <class Format>
std::size_t CapsuleDecoder<Format>::search(CapsuleBytes bytes, Decoded& out) {
    std::size_t count = 1;
    while (count + 1 < bytes.size() && !opens_capsule(bytes[count], bytes[count + 1])) {
        ++count;
    }
    damage_->give_up(count, out);
    return count;
}

/// Takes an intact capsule: it completes the one held and is held in its place.
template <class Format>
void CapsuleDecoder<Format>::accept(CapsuleBytes bytes, SampleTime arrival, Decoded& out) {
    if (damage_) {
        damage_->report_skipped(out);
    }
    const StartWord start{load_le16(bytes.template subspan<Format::start_word_at, 2>())};
    if (start.restart()) {
        restart(out);
    }
    if (held_) {
        finish_held(bytes, start.angle(), arrival, out);
    } else {
        held_.emplace();
        paused_ = 0;
    }
    damage_.reset();
    std::copy(bytes.begin(), bytes.end(), held_->bytes.begin());
    held_->start = start.angle();
    held_->arrival = arrival;
}

template <class Format>
void CapsuleDecoder<Format>::restart(Decoded& out) {
    if (held_) {
        out.events.push_back({out.samples.size(), DecodeEventKind::encoder_reset});
    }
    out.events.push_back({out.samples.size(), DecodeEventKind::scan_reset});
    held_.reset();
    rate_.forget();
    format_.restart();
}

/// Decodes the capsule held, now that the next one is known, if its share of the turn between is
/// sure.
template <class Format>
void CapsuleDecoder<Format>::finish_held(
    CapsuleBytes next,
    AngleQ6 next_start,
    SampleTime arrival,
    Decoded& out
) {
    const auto turned = turned_q8(held_->start, next_start);
    const auto pause = pause_before(arrival);
    const bool is_sudden = pause > 2 * std::exchange(paused_, pause);
    if (is_sudden && hides_turns(pause, turned)) {
        // At least this one; of how long the pause was, the times of what follows tell.
        out.events.push_back({out.samples.size(), DecodeEventKind::packets_lost});
        rate_.forget();  // meanwhile, the speed may have become another
        return;
    }
    const auto times = damage_ ? rate_.packet_times(turned) : rate_.learn(turned);
    if (!times) {
        return;
    }
    if (!damage_ || *times == 1 || damage_->sync_followed()) {
        decode_held(turned / *times, next, *times == 1, out);
    }
    const auto told = damage_ && damage_->sync_followed() ? 1 : 0;  // as a checksum error
    if (*times > 1 + told) {
        const auto lost = static_cast<std::size_t>(*times - 1 - told);
        out.events.push_back({out.samples.size(), DecodeEventKind::packets_lost, lost});
    }
}

/// How many packets did not come between the one held and the one that is here since `arrival`, by
/// the time between the two: the nearest whole number, 0 if the time of a packet is not known.
template <class Format>
std::int64_t CapsuleDecoder<Format>::pause_before(SampleTime arrival) const {
    if (packet_time().count() <= 0) {
        return 0;
    }
    const auto times = (arrival - held_->arrival + packet_time() / 2) / packet_time();
    return std::max<std::int64_t>(times - 1, 0);
}

/// Whether a pause of so many packets makes it unknown by how much the scanner turned meanwhile: by
/// `turned`, or by that and any number of whole turns.
template <class Format>
bool CapsuleDecoder<Format>::hides_turns(std::int64_t pause, std::int32_t turned) const {
    if (!rate_.steady()) {
        // The latency timer of USB adapters (protocol.md 13.20), and some.
        constexpr std::chrono::milliseconds may_be_late{20};
        return pause * packet_time() > may_be_late;
    }
    const auto times = rate_.packet_times(turned);
    return !times || (pause + 1) * turned / *times >= turn_q8 / 2;
}

template <class Format>
void CapsuleDecoder<Format>::decode_held(
    std::int32_t turned_q8,
    CapsuleBytes next,
    bool next_follows,
    Decoded& out
) {
    if (turned_q8 > greatest_turn_q8_) {
        return;
    }
    constexpr auto count = Format::samples_per_capsule;
    const auto first = out.samples.size();
    out.samples.resize(first + count);
    const auto duration = timing_.sample_duration();
    format_.decode(
        {.bytes = held_->bytes,
         .next = next,
         .next_follows = next_follows,
         .start = held_->start,
         .turned_q8 = turned_q8,
         .first_sample = timing_.last_sample(held_->arrival) - (count - 1) * duration,
         .sample_duration = duration},
        out.samples.data() + first
    );
}

}  // namespace sweepcast::protocol
