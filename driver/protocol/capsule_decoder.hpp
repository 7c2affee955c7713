// CapsuleDecoder: what the four capsule streams (0x82, 0x84, 0x85, 0x86) have in common: finding
// capsules, holding each until the next is in, judging what happened in between.
#pragma once

#include "driver/protocol/backlog.hpp"
#include "driver/protocol/capsule.hpp"
#include "driver/protocol/decoded.hpp"
#include "driver/protocol/line_damage.hpp"
#include "driver/protocol/sample_timing.hpp"
#include "driver/protocol/turn_rate.hpp"

#include <boost/container/static_vector.hpp>

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
    ExactTime first_sample;
    std::chrono::nanoseconds sample_duration{};
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
///    likewise, where the vendor stretches the capsule before it over the gap. One such turn after
///    the other is another speed, unless the capsules come as late as if packets were missing;
///  - after a pause in which the scanner may have turned by half a turn or more, or before which
///    the rate was not steady (if the pause is longer than hosts and adapters are late), nobody
///    knows how far it turned: the capsule before the pause is given up. Bytes that a line
///    delivers late have the times at which it could have had them, so they make no pause; those
///    of a network may. It is none either if the capsule before came after one at least half as
///    long: then the scanner is slower than it says;
///  - if the turn fits no rate known and the next capsule came late, a packet may be missing, or
///    the host was late (not if all are late: again, the scanner is slow): the capsule waits, and
///    those after it, until two turns in a row agree and tell the rate; four turns at most, and no
///    longer than until damage, a pause or a restart. One still in doubt is decoded if the scanner
///    turned no less afterwards, else given up.
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
        std::int32_t turned_q8{};  ///< up to the next one
        bool next_is_late{};       ///< so late that one may be missing before it
        /// In how many packets' time it turned so far: nothing while in doubt, 0 if given up.
        std::optional<std::int32_t> packets{};
    };
    /// The first may be in doubt, the last waits for the next.
    static constexpr std::size_t most_held = 6;
    /// If more are late in a row, the scanner is slower than it says.
    static constexpr std::uint64_t most_late_in_a_row = 4;

    std::size_t step(const TimedBytes& input, Decoded& out);
    std::size_t search(CapsuleBytes bytes, Decoded& out);
    void accept(CapsuleBytes bytes, SampleTime arrival, Decoded& out);
    void restart(Decoded& out);
    void follow(CapsuleBytes next, AngleQ6 next_start, SampleTime arrival, Decoded& out);
    void finish_before_damage(CapsuleBytes next, std::int32_t turned_q8, Decoded& out);
    void settle_doubts();
    void finish_first(Decoded& out);
    void finish_all_but_last(Decoded& out);
    [[nodiscard]] std::chrono::nanoseconds packet_time() const {
        return timing_.sample_duration() * std::int64_t{Format::samples_per_capsule};
    }
    [[nodiscard]] std::int64_t pause_before(SampleTime arrival) const;
    [[nodiscard]] bool hides_turns(std::int64_t pause, std::int32_t turned) const;
    [[nodiscard]] std::chrono::nanoseconds latest_after(int packets) const;
    void decode(
        const Held& held,
        std::int32_t turned_q8,
        CapsuleBytes next,
        bool next_follows,
        Decoded& out
    );

    SampleTiming timing_;
    std::int32_t greatest_turn_q8_;
    Format format_;
    Backlog<2 * capsule_size> backlog_;
    TurnRate rate_;
    boost::container::static_vector<Held, most_held> held_;  ///< in order
    std::optional<LineDamage> damage_;
    std::uint64_t late_in_a_row_{};
    std::int64_t paused_{};  ///< for how many packets, before the latest capsule held
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
            finish_all_but_last(out);
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

/// Takes an intact capsule: it completes the latest held, and is held in turn.
template <class Format>
void CapsuleDecoder<Format>::accept(CapsuleBytes bytes, SampleTime arrival, Decoded& out) {
    if (damage_) {
        damage_->report_skipped(out);
    }
    const StartWord start{load_le16(bytes.template subspan<Format::start_word_at, 2>())};
    if (start.restart()) {
        restart(out);
    }
    if (held_.empty()) {
        paused_ = 0;
    } else {
        follow(bytes, start.angle(), arrival, out);
    }
    damage_.reset();
    auto& held = held_.emplace_back();
    std::copy(bytes.begin(), bytes.end(), held.bytes.begin());
    held.start = start.angle();
    held.arrival = arrival;
    if (!held_.front().packets) {
        settle_doubts();
    }
    while (held_.size() > 1 && (held_.front().packets || held_.size() == most_held)) {
        finish_first(out);
    }
}

template <class Format>
void CapsuleDecoder<Format>::restart(Decoded& out) {
    if (!held_.empty()) {
        finish_all_but_last(out);
        out.events.push_back({out.samples.size(), DecodeEventKind::encoder_reset});
    }
    out.events.push_back({out.samples.size(), DecodeEventKind::scan_reset});
    held_.clear();
    rate_.forget();
    format_.restart();
}

/// Judges how far the scanner turned since the latest capsule held, now that the next one is there.
template <class Format>
void CapsuleDecoder<Format>::follow(
    CapsuleBytes next,
    AngleQ6 next_start,
    SampleTime arrival,
    Decoded& out
) {
    auto& latest = held_.back();
    const auto turned = turned_q8(latest.start, next_start);
    const auto pause = pause_before(arrival);
    const bool is_sudden = pause > 2 * std::exchange(paused_, pause);
    if (is_sudden && hides_turns(pause, turned)) {
        finish_all_but_last(out);
        // At least this one; of how long the pause was, the times of what follows tell.
        out.events.push_back({out.samples.size(), DecodeEventKind::packets_lost});
        held_.clear();
        rate_.forget();  // meanwhile, the speed may have become another
    } else if (damage_) {
        finish_before_damage(next, turned, out);
    } else {
        latest.turned_q8 = turned;
        latest.next_is_late = arrival - latest.arrival > latest_after(1);
        late_in_a_row_ = latest.next_is_late ? late_in_a_row_ + 1 : 0;
        latest.packets = rate_.packet_times(turned);
        if (!latest.next_is_late || latest.packets.value_or(1) == 1) {
            latest.packets = rate_.learn(turned);
        }
        if (!latest.packets && (!latest.next_is_late || late_in_a_row_ > most_late_in_a_row)) {
            latest.packets = 1;
        }
    }
}

/// Decodes the capsule held, the only one, if its share of the turn up to the next one is sure.
template <class Format>
void CapsuleDecoder<Format>::finish_before_damage(
    CapsuleBytes next,
    std::int32_t turned,
    Decoded& out
) {
    if (const auto times = rate_.packet_times(turned)) {
        if (*times == 1 || damage_->sync_followed()) {
            decode(held_.front(), turned / *times, next, *times == 1, out);
        }
        const auto told = damage_->sync_followed() ? 1 : 0;  // as a checksum error
        if (*times > 1 + told) {
            const auto lost = static_cast<std::size_t>(*times - 1 - told);
            out.events.push_back({out.samples.size(), DecodeEventKind::packets_lost, lost});
        }
    }
    held_.clear();
}

/// Judges all the turns between capsules held by the latest two, if these agree and tell the rate.
template <class Format>
void CapsuleDecoder<Format>::settle_doubts() {
    if (held_.size() < 3) {
        return;
    }
    const auto latest = std::span(held_).last(3);
    const auto rate = common_rate(latest[0].turned_q8, latest[1].turned_q8);
    if (!rate || latest[2].arrival - latest[0].arrival > latest_after(2)) {
        return;
    }
    for (auto& held : std::span(held_).first(held_.size() - 1)) {
        const auto usual = held.next_is_late ? 0 : 1;
        held.packets = packet_times_at(*rate, held.turned_q8).value_or(usual);
    }
}

/// Decodes the first capsule held, which another one follows, unless it is given up.
template <class Format>
void CapsuleDecoder<Format>::finish_first(Decoded& out) {
    const auto& first = held_.front();
    const auto after = std::span(held_).subspan(1, held_.size() - 2);
    const auto turned_no_less = [&](const Held& then) {
        return packet_times_at(then.turned_q8, first.turned_q8) == 1;
    };
    const bool is_likely = !std::ranges::all_of(after, &Held::next_is_late) &&
                           std::ranges::all_of(after, turned_no_less);
    const auto packets = first.packets.value_or(is_likely ? 1 : 0);
    if (packets > 0) {
        decode(first, first.turned_q8 / packets, held_[1].bytes, packets == 1, out);
    }
    if (const auto lost = packets > 0 ? packets - 1 : 1; lost > 0) {
        out.events.push_back(
            {out.samples.size(), DecodeEventKind::packets_lost, static_cast<std::size_t>(lost)}
        );
    }
    held_.erase(held_.begin());
}

template <class Format>
void CapsuleDecoder<Format>::finish_all_but_last(Decoded& out) {
    while (held_.size() > 1) {
        finish_first(out);
    }
}

/// How many packets did not come between the latest held and the one that is here since `arrival`,
/// by the time between the two: the nearest whole number, 0 if the time of a packet is not known.
template <class Format>
std::int64_t CapsuleDecoder<Format>::pause_before(SampleTime arrival) const {
    if (packet_time().count() <= 0) {
        return 0;
    }
    const auto times = (arrival - held_.back().arrival + packet_time() / 2) / packet_time();
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

/// What so many packets in a row take at most if none is missing among them, hosts being somewhat
/// late. Without the time of a packet there is no such limit.
template <class Format>
std::chrono::nanoseconds CapsuleDecoder<Format>::latest_after(int packets) const {
    return packet_time().count() > 0 ? packets * packet_time() * 5 / 4
                                     : std::chrono::nanoseconds::max();
}

template <class Format>
void CapsuleDecoder<Format>::decode(
    const Held& held,
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
    format_.decode(
        {.bytes = held.bytes,
         .next = next,
         .next_follows = next_follows,
         .start = held.start,
         .turned_q8 = turned_q8,
         .first_sample = timing_.first_sample(held.arrival, count),
         .sample_duration = timing_.sample_duration()},
        out.samples.data() + first
    );
}

}  // namespace sweepcast::protocol
