// The constant part of the delay between a measurement and the arrival of its packet.
#include "driver/protocol/sample_timing.hpp"

#include <algorithm>
#include <cstdint>

namespace sweepcast::protocol {
namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

std::uint32_t usual_baud(AnswerType type) {
    switch (type) {
    case AnswerType::normal:
    case AnswerType::express:
        return 115200;
    case AnswerType::ultra:
    case AnswerType::dense:
        return 256000;
    case AnswerType::hq:
    case AnswerType::ultra_dense:
        return 1000000;
    }
    return 115200;
}

/// Bytes that must be on the line before a sample can be decoded. In HQ each sample counts for
/// itself.
std::size_t transmitted_bytes(AnswerType type) {
    return type == AnswerType::hq ? 8 : packet_size(type);
}

microseconds transmission(AnswerType type, const DecodeSettings& settings) {
    if (settings.ethernet) {
        return microseconds{100};
    }
    const std::uint64_t baud = settings.baud != 0 ? settings.baud : usual_baud(type);
    return microseconds{10'000'000U * transmitted_bytes(type) / baud};
}

nanoseconds plausible(nanoseconds sample_duration) {
    return sample_duration < microseconds{1}
               ? nanoseconds{0}
               : std::min<nanoseconds>(sample_duration, std::chrono::seconds{1});
}

}  // namespace

SampleTiming::SampleTiming(AnswerType type, const DecodeSettings& settings)
    : sample_duration_(plausible(settings.sample_duration))
    , delay_(
          std::chrono::floor<microseconds>(sample_duration_ + sample_duration_ / 2) +
          transmission(type, settings)
      ) {}

}  // namespace sweepcast::protocol
