// Express capsules -> samples, with recovery from damage.
#include "driver/protocol/decode_express.hpp"

#include "driver/protocol/encode_express.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>

namespace sweepcast::protocol {
namespace {

/// Skipped bytes are reported at the latest when this many have gathered, so that a stream of
/// nothing but noise shows.
constexpr std::size_t report_after = 1024;

constexpr std::uint8_t quality_with_echo = 0x2F << 2;

}  // namespace

ExpressDecoder::ExpressDecoder(const DecodeSettings& settings)
    : timing_(AnswerType::express, settings) {}

void ExpressDecoder::push(
    std::span<const std::uint8_t> bytes,
    const Arrival& arrival,
    Decoded& out
) {
    backlog_.feed(bytes, arrival, [&](const TimedBytes& input) { return step(input, out); });
}

/// Deals with the capsule or the noise at the front of `input`.
std::size_t ExpressDecoder::step(const TimedBytes& input, Decoded& out) {
    const auto bytes = input.bytes();
    if (bytes.size() < capsule_size) {
        return 0;
    }
    const auto capsule = bytes.first<capsule_size>();
    if (!damage_ && !intact_capsule(capsule)) {
        lose_step(capsule, out);
    }
    if (damage_) {
        const bool in_step = damage_->bytes % capsule_size == 0;
        if (!intact_capsule(capsule)) {
            return search(bytes, out);
        }
        if (!in_step) {
            if (bytes.size() < 2 * capsule_size) {
                return 0;
            }
            if (!intact_capsule(bytes.subspan<capsule_size, capsule_size>())) {
                give_up(1, out);
                return 1;
            }
        }
    }
    accept(capsule, input.arrival_of(capsule_size - 1), out);
    return capsule_size;
}

/// Gives up the bytes before the next place where a capsule may begin; at least one.
std::size_t ExpressDecoder::search(std::span<const std::uint8_t> bytes, Decoded& out) {
    std::size_t count = 1;
    while (count + 1 < bytes.size() && !opens_capsule(bytes[count], bytes[count + 1])) {
        ++count;
    }
    give_up(count, out);
    return count;
}

void ExpressDecoder::lose_step(CapsuleBytes bytes, Decoded& out) {
    damage_ = Damage{.sync_followed = opens_capsule(bytes[0], bytes[1])};
    if (damage_->sync_followed) {
        out.events.push_back({out.samples.size(), DecodeEventKind::checksum_error});
    }
}

void ExpressDecoder::give_up(std::size_t count, Decoded& out) {
    // The bytes of the damaged capsule are accounted for by its checksum error.
    const auto accounted_for = damage_->sync_followed ? capsule_size : 0;
    const auto before = std::max(damage_->bytes, accounted_for);
    damage_->bytes += count;
    damage_->unreported += std::max(damage_->bytes, accounted_for) - before;
    if (damage_->unreported >= report_after) {
        report_skipped(out);
    }
}

void ExpressDecoder::report_skipped(Decoded& out) {
    if (damage_->unreported > 0) {
        out.events.push_back(
            {out.samples.size(), DecodeEventKind::bytes_skipped, damage_->unreported}
        );
        damage_->unreported = 0;
    }
}

/// Takes an intact capsule: it completes the one held and is held in its place.
void ExpressDecoder::accept(CapsuleBytes bytes, SampleTime arrival, Decoded& out) {
    if (damage_) {
        report_skipped(out);
    }
    const StartWord start{load_le16(bytes.subspan<2, 2>())};
    if (start.restart()) {
        if (held_) {
            out.events.push_back({out.samples.size(), DecodeEventKind::encoder_reset});
        }
        out.events.push_back({out.samples.size(), DecodeEventKind::scan_reset});
        held_.reset();
        rate_.forget();
    }
    if (held_) {
        finish_held(start, out);
    } else {
        held_ = Held{};
    }
    damage_.reset();
    std::copy(bytes.begin(), bytes.end(), held_->bytes.begin());
    held_->start = start;
    held_->arrival = arrival;
}

/// Decodes the capsule held, now that the next one is known, if its share of the turn between is
/// sure.
void ExpressDecoder::finish_held(StartWord next, Decoded& out) {
    const auto turned = turned_q8(held_->start.angle(), next.angle());
    if (!damage_) {
        decode_held(turned / rate_.learn(turned), out);
        return;
    }
    const auto times = rate_.packet_times(turned);
    if (times && (*times == 1 || damage_->sync_followed)) {
        decode_held(turned / *times, out);
    }
}

void ExpressDecoder::decode_held(std::int32_t turned_q8, Decoded& out) const {
    const auto first = out.samples.size();
    out.samples.resize(first + express_samples_per_capsule);
    auto* sample = out.samples.data() + first;

    const std::int32_t increment = turned_q8 * 8;  // q16: a 32nd of the turn
    std::int32_t raw = held_->start.angle().raw * 1024;
    // The same within one turn. The vendor tests `next raw % turn < increment`: the turn ends in
    // this step.
    std::int32_t in_turn = raw % turn_q16;
    auto time = timing_.last_sample(held_->arrival) -
                (express_samples_per_capsule - 1) * timing_.sample_duration();
    const auto put = [&](unsigned word, unsigned offset_q3) {
        const auto corrected = raw - static_cast<std::int32_t>(offset_q3) * 8192;
        raw += increment;
        in_turn += increment;
        const bool turn_ends = in_turn >= turn_q16;
        in_turn -= turn_ends ? turn_q16 : 0;
        sample->time = time;
        sample->distance.raw = word & 0xFFFCU;
        sample->angle = angle_from_q6(corrected >> 10);
        sample->quality = sample->distance.has_echo() ? quality_with_echo : 0;
        sample->flag = turn_ends ? 1 : 2;
        time += timing_.sample_duration();
        ++sample;
    };
    const std::span<const std::uint8_t> bytes{held_->bytes};
    for (std::size_t at = 4; at < capsule_size; at += 5) {
        const unsigned word1 = load_le16(bytes.subspan(at).first<2>());
        const unsigned word2 = load_le16(bytes.subspan(at + 2).first<2>());
        const unsigned offsets = bytes[at + 4];
        put(word1, (offsets & 15U) | (word1 & 3U) << 4);
        put(word2, offsets >> 4 | (word2 & 3U) << 4);
    }
}

}  // namespace sweepcast::protocol
