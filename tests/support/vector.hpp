// Golden vectors: recorded streams and what the vendor's decoder makes of them
// (tests/vectors/README.md).
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/decoded.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sweepcast::test {

/// How the stream of a timing case was handed over, and the times that came out.
struct VectorTiming {
    protocol::DecodeSettings settings;
    std::size_t chunk_bytes{};
    protocol::SampleTime first_chunk{};
    std::chrono::microseconds between_chunks{};
    std::vector<protocol::SampleTime> sample_times;
};

/// One case.
struct Vector {
    std::vector<std::uint8_t> bytes;
    protocol::AnswerType type{};
    protocol::DecodeSettings settings;
    /// What the vendor's decoder gives; times are 0 except in timing cases.
    protocol::Decoded expected;
    std::optional<VectorTiming> timing;
};

/// The file that holds the bytes of a case.
[[nodiscard]] std::string vector_path(const std::string& name);

/// Loads a case, e.g. "82_room". Throws if it cannot be read: the test then fails.
[[nodiscard]] Vector load_vector(const std::string& name);

}  // namespace sweepcast::test
