// Arrivals in, times out: what the line did, and the pieces of the line that is given out.
#include "driver/protocol/sample_clock.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sweepcast::protocol {
namespace {

constexpr double ms = 1e6;

/// Until more is known: the latency timer of USB adapters, and some.
constexpr double unsettled_uncertainty = 20 * ms;
/// Whole microseconds, several times: durations, the time on the line, arrivals.
constexpr double rounding = 10e3;
/// How long a count is in doubt after damage: until the envelope has noticed that it was wrong.
constexpr double doubt_lasts = 400 * ms;
/// Later than any adapter delivers.
constexpr double longest_delay = 40 * ms;
/// More than a line holds back; a host that is held up may have more waiting.
constexpr double longest_backlog = 300 * ms;
/// How long bytes have to stay late until they are not: longer than it takes to catch up, for a
/// lidar behind a full line; or, beyond any backlog of a line, for a host that reads what waited.
constexpr double backlog_read = 300 * ms;
constexpr double pause_sure = 20 * ms;
constexpr double epoch = 2000 * ms;
/// A step forward by more is made at once, as something is missing.
constexpr double greatest_bend = 1 * ms;
/// Corrections are spread over sixteen times as long, at least this; back from what was taken for a
/// pause and was none, over twice as long: times in the future are worse than uneven ones.
constexpr double bend_spread = 16.0;
constexpr double return_spread = 2.0;
constexpr double shortest_bend = 100 * ms;

/// The decoder's delay of 0x83 counts a single sample of its packets, as the vendor's does.
double bytes_not_subtracted(AnswerType type) {
    return type == AnswerType::hq ? static_cast<double>(packet_size(type)) - 8.0 : 0.0;
}

double in_ns(std::chrono::nanoseconds duration) {
    return static_cast<double>(std::clamp<std::int64_t>(duration.count(), 0, 1'000'000'000));
}

}  // namespace

SampleClock::SampleClock(const SampleClockSettings& settings)
    : samples_per_packet_(samples_per_packet(settings.type))
    , holds_packet_(settings.type != AnswerType::normal && settings.type != AnswerType::hq)
    , packet_bytes_(static_cast<double>(packet_size(settings.type)))
    , nominal_step_(in_ns(settings.sample_duration))
    , per_byte_(in_ns(settings.per_byte))
    , sending_(bytes_not_subtracted(settings.type) * per_byte_)
    , envelope_(nominal_step_) {}

void SampleClock::retime(Decoded& decoded, std::size_t bytes, SampleTime arrival) {
    if (!started_) {
        started_ = true;
        start_ = arrival;
    }
    const auto now = since_start(arrival);
    note_read(bytes, now);
    observe(decoded, now);
    if (!decoded.samples.empty()) {
        notice_pause(now);
        assign(decoded);
        decoded.time_uncertainty =
            std::chrono::microseconds(std::llround(std::ceil(uncertainty(now) / 1e3)));
    }
}

void SampleClock::note_read(std::size_t bytes, double now) {
    if (now >= epoch_ends_) {
        before_ = std::exchange(lately_, {});
        epoch_ends_ = now + epoch;
    }
    bytes_ += bytes;
    const auto packet = static_cast<std::size_t>(packet_bytes_);
    lately_.greatest_read = std::max(lately_.greatest_read, bytes);
    lately_.cut_reads += bytes != packet || bytes_ % packet != 0 ? 1U : 0U;
}

/// Counts what was lost as far as it is known, and doubts the count.
void SampleClock::note_damage(const DecodeEvent& event, double now) {
    const auto samples = static_cast<double>(samples_per_packet_);
    const auto count = static_cast<double>(event.count);
    double lost = 0.0;
    switch (event.kind) {
    case DecodeEventKind::checksum_error:
        lost = count * samples;
        break;
    case DecodeEventKind::bytes_skipped:
        lost = std::round(count / packet_bytes_) * samples;
        break;
    case DecodeEventKind::packets_lost:
    case DecodeEventKind::encoder_reset:
        count_ += count * samples;
        break;
    case DecodeEventKind::scan_reset:
        break;
    }
    (holds_packet_ ? lost_after_ : count_) += lost;
    doubt_ = packet_time() * (now < doubt_ends_ ? 2.0 : 1.0);
    doubt_ends_ = now + doubt_lasts;
}

/// Counts the samples, and adds their packets to the envelope.
void SampleClock::observe(const Decoded& decoded, double now) {
    counts_.clear();
    auto event = decoded.events.begin();
    const auto note_damage_up_to = [&](std::size_t sample) {
        for (; event != decoded.events.end() && event->at_sample <= sample; ++event) {
            note_damage(*event, now);
        }
    };
    for (std::size_t i = 0; i + samples_per_packet_ <= decoded.samples.size();
         i += samples_per_packet_) {
        note_damage_up_to(i);
        counts_.push_back(count_);
        observe_packet(decoded.samples[i + samples_per_packet_ - 1], now);
        count_ += static_cast<double>(samples_per_packet_) + std::exchange(lost_after_, 0.0);
    }
    note_damage_up_to(decoded.samples.size());
}

void SampleClock::observe_packet(const Sample& last, double now) {
    const auto count = count_ + static_cast<double>(samples_per_packet_ - 1);
    const auto time = since_start(last.time) - sending_;
    if (!envelope_.empty()) {
        // Nothing comes early: more was taken for lost than was.
        const auto above = envelope_.above(count, time);
        if (now < doubt_ends_ && packet_time() > 0.0 && above < -packet_time() / 2) {
            envelope_.shift(std::round(above / packet_time()) * packet_time());
        }
    }
    envelope_.add(count, time, unseen_delay());
    last_above_ = envelope_.above(count, time);
}

/// What stays late by more than any adapter holds bytes was not taken before: the scanner made a
/// pause, or much is lost. A host that was not scheduled reads what is late at once.
void SampleClock::notice_pause(double now) {
    if (last_above_ <= longest_delay || !envelope_.settled()) {
        late_since_.reset();
        return;
    }
    if (!late_since_) {
        late_since_ = now;
    }
    if (now - *late_since_ >= (last_above_ > longest_backlog ? pause_sure : backlog_read)) {
        envelope_.shift(last_above_);
        last_above_ = 0.0;
        late_since_.reset();
        doubt_ = longest_delay;
        doubt_ends_ = now + doubt_lasts;
    }
}

/// Puts the samples on the line that is given out.
void SampleClock::assign(Decoded& decoded) {
    off_ = 0.0;
    auto* sample = decoded.samples.data();
    for (const auto first : counts_) {
        aim(first);
        for (std::size_t k = 0; k < samples_per_packet_; ++k, ++sample) {
            const auto time = drawn(first + static_cast<double>(k));
            sample->time = start_ + std::chrono::microseconds(std::llround(time / 1e3));
        }
        const auto last = first + static_cast<double>(samples_per_packet_ - 1);
        off_ = std::max(off_, std::abs(envelope_.line().at(last) - drawn(last)));
    }
}

/// Leads the line that is given out towards the envelope, if it has come too far from it.
void SampleClock::aim(double count) {
    const auto& line = envelope_.line();
    if (!drawing_) {
        drawing_ = true;
        corner_count_ = bend_count_ = count;
        corner_time_ = line.at(count);
        step_ = next_step_ = line.step;
        return;
    }
    const auto last = count + static_cast<double>(samples_per_packet_ - 1);
    const auto goal = std::max(last, bend_count_);
    const auto tolerance = std::clamp(envelope_.scatter() / 8, rounding / 2, 5 * rounding);
    if (std::abs(line.at(goal) - drawn(goal)) <= tolerance) {
        return;
    }
    const auto from = drawn(count);
    const auto behind = line.at(count) - from;
    corner_count_ = bend_count_ = count;
    corner_time_ = from;
    step_ = next_step_ = line.step;
    if (behind > greatest_bend) {
        corner_time_ = line.at(count);
    } else if (line.step > 0.0) {
        const auto times_as_long = behind < -longest_delay ? return_spread : bend_spread;
        const auto spread = std::max(times_as_long * std::abs(behind), shortest_bend) / line.step;
        step_ = line.step + behind / spread;
        bend_count_ = count + spread;
    }
}

/// The line that is given out.
double SampleClock::drawn(double count) const {
    const auto bent = std::max(count - bend_count_, 0.0);
    return corner_time_ + step_ * (count - bent - corner_count_) + next_step_ * bent;
}

/// How late everything may be without that being seen. A reader that polls sees bytes when it
/// polls: those of the next packet, if it has begun, tell how long ago the one before ended; so
/// what remains is no more than the time between two packets on the line and a byte, or between two
/// polls. Nothing if every read so far was just one packet: who wakes for packets does not poll.
double SampleClock::unseen_delay() const {
    if (lately_.cut_reads + before_.cut_reads == 0) {
        return 0.0;
    }
    const auto greatest = std::max(lately_.greatest_read, before_.greatest_read);
    const auto polled = per_byte_ * static_cast<double>(greatest);
    const auto idle = packet_time() - per_byte_ * packet_bytes_;
    return std::min(std::max(idle, 0.0) + per_byte_, polled);
}

double SampleClock::uncertainty(double now) const {
    auto result = rounding + off_ + (now < doubt_ends_ ? doubt_ : 0.0);
    result += late_since_ ? last_above_ : 0.0;
    if (!envelope_.settled()) {
        return result + unsettled_uncertainty;
    }
    const auto care = envelope_.experienced() ? 1.0 : 2.0;
    const auto seen = care * std::max(envelope_.scatter(), envelope_.latest_above());
    return result + std::max(2.0 * seen, unseen_delay() + seen / 2);
}

/// From one packet to the next.
double SampleClock::packet_time() const {
    return envelope_.line().step * static_cast<double>(samples_per_packet_);
}

double SampleClock::since_start(SampleTime time) const {
    return static_cast<double>((time - start_).count()) * 1e3;
}

}  // namespace sweepcast::protocol
