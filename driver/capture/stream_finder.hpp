// StreamFinder: the measurement streams in a capture, as a decoder wants them.
#pragma once

#include "driver/capture/capture_record.hpp"
#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/descriptor_hunter.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

namespace sweepcast::capture {

/// Bytes of a stream that arrived together.
struct StreamBlock {
    protocol::AnswerType type{};
    bool begins{};  ///< a new stream: whatever was decoded before is over
    std::chrono::nanoseconds at{};
    std::span<const std::uint8_t> bytes;  ///< of the record; none if only the descriptor was there
};

/// A stream begins after a descriptor of measurements and ends with the next request, except those
/// that only speak to the motor (protocol.md 13.24).
class StreamFinder {
public:
    /// Takes the records in their order; gives what of a stream is in this one.
    std::optional<StreamBlock> push(const CaptureRecord& record);

private:
    void end_stream();

    protocol::DescriptorHunter hunter_{protocol::Expectation::measurement()};
    std::optional<protocol::AnswerType> stream_;
};

}  // namespace sweepcast::capture
