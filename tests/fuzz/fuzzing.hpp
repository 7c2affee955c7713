// What the fuzzers share: taking choices off the front of an input, cutting the rest anywhere, and
// stopping when something does not hold.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

namespace sweepcast::fuzz {

using Input = std::span<const std::uint8_t>;

/// Stops the fuzzer, which then keeps the input, unless `holds`.
inline void require(bool holds) {
    if (!holds) {
        std::abort();
    }
}

/// Takes the first byte off the input; 0 if there is none.
inline std::uint8_t take_byte(Input& input) {
    if (input.empty()) {
        return 0;
    }
    const auto byte = input.front();
    input = input.subspan(1);
    return byte;
}

/// Sizes of pieces that follow from one byte, the same every time.
class Cuts {
public:
    explicit Cuts(std::uint8_t seed) : state_(seed) {}

    /// 1 to 512, small ones as often as large ones.
    std::size_t next() {
        state_ = state_ * 1103515245U + 12345U;
        const auto random = state_ >> 16;
        return 1 + (random & ((1U << (random >> 9 & 7U) << 2U) - 1U));
    }

private:
    std::uint32_t state_;
};

}  // namespace sweepcast::fuzz

/// What libFuzzer calls; each fuzzer defines it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
