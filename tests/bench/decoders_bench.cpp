// How fast each answer type decodes: samples a second and processor cycles a sample, on one core,
// fed as a serial port gives it: 512 bytes at a time. Beside it the vendor's decoder, as it was
// measured in the same way (2 cores of an AMD EPYC, -O2), and how many times faster ours is.
#include "driver/protocol/decode.hpp"
#include "tests/support/vector.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace sweepcast::protocol {
namespace {

constexpr std::size_t chunk_bytes = 512;
constexpr std::size_t least_stream_bytes = 60'000;

/// The time stamp counter, which runs at the processor's nominal frequency; 0 where there is none.
/// It goes on while others have the processor, so the quickest pass over the stream counts.
std::uint64_t cycles() {
#if defined(__x86_64__)
    return __builtin_ia32_rdtsc();
#else
    return 0;
#endif
}

/// A clean stream of a turning scanner, repeated so that chunks cut its packets everywhere.
std::vector<std::uint8_t> long_stream(const test::Vector& vector) {
    std::vector<std::uint8_t> bytes;
    while (bytes.size() < least_stream_bytes) {
        bytes.insert(bytes.end(), vector.bytes.begin(), vector.bytes.end());
    }
    return bytes;
}

void decode_room(benchmark::State& state, const std::string& name, double vendors_millions) {
    const auto vector = test::load_vector(name);
    const auto stream = long_stream(vector);
    auto decoder = Decoder::create(vector.type, vector.settings).value();
    Decoded decoded;
    std::uint64_t samples = 0;
    double least_cycles = std::numeric_limits<double>::max();
    for ([[maybe_unused]] auto _ : state) {
        const auto samples_before = samples;
        const auto begin = cycles();
        for (std::span<const std::uint8_t> rest{stream}; !rest.empty();) {
            const auto chunk = rest.first(std::min(chunk_bytes, rest.size()));
            rest = rest.subspan(chunk.size());
            decoded.clear();
            decoder.push(chunk, {}, decoded);
            benchmark::DoNotOptimize(decoded.samples.data());
            benchmark::ClobberMemory();
            samples += decoded.samples.size();
        }
        const auto spent = static_cast<double>(cycles() - begin);
        least_cycles =
            std::min(least_cycles, spent / static_cast<double>(samples - samples_before));
    }
    const auto count = static_cast<double>(samples);
    using benchmark::Counter;
    state.counters["Msamples/s"] = Counter(count / 1e6, Counter::kIsRate);
    state.counters["vendor's"] = vendors_millions;
    state.counters["ratio"] = Counter(count / 1e6 / vendors_millions, Counter::kIsRate);
    state.counters["cycles/sample"] = least_cycles;
}

BENCHMARK_CAPTURE(decode_room, 0x81_normal, "81_room", 86.0);
BENCHMARK_CAPTURE(decode_room, 0x82_express, "82_room", 85.0);
BENCHMARK_CAPTURE(decode_room, 0x83_hq, "83_room", 26.0);
BENCHMARK_CAPTURE(decode_room, 0x84_ultra, "84_room", 80.0);
BENCHMARK_CAPTURE(decode_room, 0x85_dense, "85_room", 103.0);
BENCHMARK_CAPTURE(decode_room, 0x86_ultra_dense, "86_room", 86.0);

}  // namespace
}  // namespace sweepcast::protocol
