// Any bytes as a measurement stream of one answer type (SWEEPCAST_FUZZED_TYPE), fed whole, byte by
// byte, and cut anywhere: what comes out must be the same to the last bit, and make sense. Then the
// same for the sweeps made of it. The first three bytes choose settings and cuts, and whether every
// packet gets the checksum it should have, which chance alone would hardly ever give it.
#include "driver/protocol/capsule.hpp"
#include "driver/protocol/crc32.hpp"
#include "driver/protocol/decode.hpp"
#include "driver/protocol/hq_packet.hpp"
#include "driver/protocol/sweep_assembler.hpp"
#include "driver/protocol/wire.hpp"
#include "tests/fuzz/fuzzing.hpp"

#include <array>
#include <vector>

namespace sweepcast::fuzz {
namespace {

using namespace protocol;
using std::chrono::microseconds;

constexpr auto type = static_cast<AnswerType>(SWEEPCAST_FUZZED_TYPE);

DecodeSettings settings_from(std::uint8_t choice) {
    constexpr std::array<std::int64_t, 8> durations{0, 1, 31, 63, 252, 500, 1'000'000, -7};
    constexpr std::array<std::uint32_t, 4> bauds{0, 115'200, 1'000'000, 1};
    return {
        .sample_duration = microseconds{durations[choice & 7U]},
        .baud = bauds[choice >> 3 & 3U],
        .ethernet = (choice & 32U) != 0};
}

/// The same packets, end to end, as intact ones.
std::vector<std::uint8_t> seal_packets(Input input) {
    std::vector<std::uint8_t> bytes(input.begin(), input.end());
    constexpr auto size = packet_size(type);
    for (std::size_t at = 0; at + size <= bytes.size(); at += size) {
        const auto packet = std::span(bytes).subspan(at, size);
        if constexpr (type == AnswerType::hq) {
            packet[0] = hq_sync_byte;
            const auto checksum = crc32_padded(packet.first(hq_checksum_at));
            store_le32(packet.subspan(hq_checksum_at).first<4>(), checksum);
        } else if constexpr (type != AnswerType::normal) {
            seal_capsule(packet);
        }
    }
    return bytes;
}

struct Outcome {
    Decoded decoded;
    std::vector<Sweep> sweeps;
};

/// Decodes pieces of the sizes that `next_size` says. Byte i always arrives at the same time.
template <class NextSize>
Outcome run(
    const DecodeSettings& settings,
    Input bytes,
    std::chrono::nanoseconds per_byte,
    NextSize next_size
) {
    auto decoder = Decoder::create(type, settings).value();
    SweepAssembler assembler;
    Outcome outcome;
    Decoded piece_decoded;
    std::chrono::nanoseconds now{0};
    while (!bytes.empty()) {
        const auto piece = bytes.first(std::min(next_size(), bytes.size()));
        bytes = bytes.subspan(piece.size());
        now += static_cast<std::int64_t>(piece.size()) * per_byte;
        piece_decoded.clear();
        decoder.push(
            piece,
            {SampleTime{std::chrono::floor<microseconds>(now)}, per_byte},
            piece_decoded
        );
        assembler.push(piece_decoded, outcome.sweeps);
        auto& all = outcome.decoded;
        for (auto event : piece_decoded.events) {
            require(event.at_sample <= piece_decoded.samples.size());
            event.at_sample += all.samples.size();
            all.events.push_back(event);
        }
        all.samples
            .insert(all.samples.end(), piece_decoded.samples.begin(), piece_decoded.samples.end());
    }
    return outcome;
}

std::size_t most_samples(std::size_t bytes) {
    constexpr std::array<std::size_t, 6> per_packet{1, 32, 96, 96, 40, 64};
    return bytes / packet_size(type) * per_packet[static_cast<std::size_t>(type) - 0x81];
}

void require_sense(const Decoded& decoded, std::size_t bytes) {
    require(decoded.samples.size() <= most_samples(bytes));
    std::size_t skipped = 0;
    std::size_t last = 0;
    for (const auto& event : decoded.events) {
        require(event.at_sample >= last && event.at_sample <= decoded.samples.size());
        require(event.count > 0);
        last = event.at_sample;
        skipped += event.kind == DecodeEventKind::bytes_skipped ? event.count : 0;
    }
    require(skipped <= bytes);
    for (const auto& sample : decoded.samples) {
        require((sample.distance.raw & 0x80000000U) == 0);
    }
}

void require_sense(const std::vector<Sweep>& sweeps) {
    for (const auto& sweep : sweeps) {
        require(!sweep.samples.empty() && sweep.samples.size() <= max_sweep_samples);
    }
}

void require_same(const Outcome& some, const Outcome& others) {
    require(some.decoded.samples == others.decoded.samples);
    require(some.decoded.events == others.decoded.events);
    require(some.sweeps == others.sweeps);
}

}  // namespace
}  // namespace sweepcast::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace sweepcast::fuzz;
    Input input{data, size};
    const auto choice = take_byte(input);
    const auto settings = settings_from(choice);
    // Whole microseconds, so that every byte has one time, whatever block it comes in.
    const std::chrono::microseconds per_byte{take_byte(input)};
    Cuts cuts{take_byte(input)};
    std::vector<std::uint8_t> sealed;
    if ((choice & 64U) != 0) {
        sealed = seal_packets(input);
        input = sealed;
    }
    const auto whole = run(settings, input, per_byte, [&] { return input.size(); });
    require_sense(whole.decoded, input.size());
    require_sense(whole.sweeps);
    require_same(whole, run(settings, input, per_byte, [] { return std::size_t{1}; }));
    require_same(whole, run(settings, input, per_byte, [&] { return cuts.next(); }));
    return 0;
}
