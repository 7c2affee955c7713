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
    for (; count < most; ++count) {
        const auto* packet = bytes.data() + count * normal_packet_size;
        if (!is_normal_packet(packet)) {
            break;
        }
        const auto arrival = input.arrival_of((count + 1) * normal_packet_size - 1);
        samples[count] = decode_packet(packet, timing_.last_sample(arrival));
    }
    for (auto i = count - std::min(count, recent_.angles.size()); i < count; ++i) {
        recent_.add(samples[i].angle);
    }
    out.samples.resize(first + count);
    if (count < most) {
        in_step_ = false;
        prior_ = recent_.prior();
    }
    if (count == 0) {
        return realign(input, out);
    }
    return count * normal_packet_size;
}

/// Gives up bytes until packets begin.
std::size_t NormalDecoder::realign(const TimedBytes& input, Decoded& out) {
    const auto alignment = find_alignment(input.bytes(), prior_);
    if (alignment.verdict == Alignment::Verdict::more) {
        return 0;
    }
    out.events.push_back({out.samples.size(), DecodeEventKind::bytes_skipped, alignment.offset});
    // Later windows begin anywhere: what is known of the place of packets held for the first one
    // only.
    prior_.angles_jump = false;
    in_step_ = alignment.verdict == Alignment::Verdict::found;
    return alignment.offset;
}

void NormalDecoder::RecentAngles::add(AngleQ14 angle) {
    if (count == angles.size()) {
        std::shift_left(angles.begin(), angles.end(), 1);
        --count;
    }
    angles[count++] = angle;
}

AlignmentPrior NormalDecoder::RecentAngles::prior() const {
    if (count == 0) {
        return {};
    }
    std::size_t jumps = 0;
    for (std::size_t i = 1; i < count; ++i) {
        jumps += angle_continues(angles[i - 1], angles[i]) ? 0U : 1U;
    }
    return {angles[count - 1], jumps >= 2};
}

}  // namespace sweepcast::protocol
