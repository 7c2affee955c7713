// Normal scan packets -> samples, with recovery from damage.
#include "driver/protocol/decode_normal.hpp"

#include "driver/protocol/normal_packet.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>

namespace sweepcast::protocol {
namespace {

/// Packets decoded between looks at what is left: bounds the room reserved ahead of a failing
/// packet.
constexpr std::size_t longest_run = 128;
/// So many angles that go on from one another make a jump suspicious.
constexpr std::uint32_t trusted_streak = 8;
/// From here on jumps are what is to be expected: two in a row, or more often than every third
/// sample.
constexpr std::uint32_t rough = 4;
constexpr std::uint32_t roughest = 8;

Sample decode_packet(const std::uint8_t* packet, SampleTime time) {
    return {
        .time = time,
        .distance = {static_cast<std::uint32_t>(packet[3] | packet[4] << 8)},
        .angle = normal_angle(packet),
        .quality = static_cast<std::uint8_t>(packet[0] & 0xFC),
        .flag = static_cast<std::uint8_t>(packet[0] & 1)};
}

}  // namespace

NormalDecoder::NormalDecoder(const DecodeSettings& settings)
    : timing_(AnswerType::normal, settings) {}

void NormalDecoder::push(
    std::span<const std::uint8_t> bytes,
    const Arrival& arrival,
    Decoded& out
) {
    backlog_.feed(bytes, arrival, [&](const TimedBytes& input) { return step(input, out); });
}

std::size_t NormalDecoder::step(const TimedBytes& input, Decoded& out) {
    if (input.bytes().size() < normal_packet_size) {
        return 0;
    }
    return in_step_ ? decode_run(input, out) : realign(input, out);
}

/// Decodes packets up to the first that fails its check bits.
std::size_t NormalDecoder::decode_run(const TimedBytes& input, Decoded& out) {
    const auto bytes = input.bytes();
    const auto most = std::min(bytes.size() / normal_packet_size, longest_run);
    const auto first = out.samples.size();
    out.samples.resize(first + most);
    auto* const samples = out.samples.data() + first;
    std::size_t count = 0;
    auto track = track_;
    for (; count < most; ++count) {
        const auto* packet = bytes.data() + count * normal_packet_size;
        if (!is_normal_packet(packet) || !track.take(normal_angle(packet))) {
            break;
        }
        const auto arrival = input.arrival_of((count + 1) * normal_packet_size - 1);
        samples[count] = decode_packet(packet, timing_.last_sample(arrival));
    }
    track_ = track;
    out.samples.resize(first + count);
    if (count < most) {
        lose_step();
    }
    return count > 0 ? count * normal_packet_size : realign(input, out);
}

void NormalDecoder::lose_step() {
    in_step_ = false;
    prior_ = {track_.last, track_.roughness >= rough};
    track_.streak = 0;
}

/// Gives up bytes until packets begin.
std::size_t NormalDecoder::realign(const TimedBytes& input, Decoded& out) {
    const auto alignment = find_alignment(input.bytes(), prior_);
    if (alignment.verdict == Alignment::Verdict::more) {
        return 0;
    }
    // Later windows begin anywhere: what is known of the place of packets holds for the first one
    // only.
    prior_.in_place = false;
    in_step_ = alignment.verdict == Alignment::Verdict::found;
    if (alignment.offset == 0) {
        return decode_run(input, out);
    }
    out.events.push_back({out.samples.size(), DecodeEventKind::bytes_skipped, alignment.offset});
    return alignment.offset;
}

bool NormalDecoder::AngleTrack::take(AngleQ14 angle) {
    const bool continues = angle_continues(last, angle);
    if (!continues && streak >= trusted_streak) {
        return false;
    }
    streak = continues ? streak + 1 : 0;
    if (continues) {
        roughness -= std::min(roughness, 1U);
    } else {
        roughness = std::min(roughness + 2, roughest);
    }
    last = angle;
    return true;
}

}  // namespace sweepcast::protocol
