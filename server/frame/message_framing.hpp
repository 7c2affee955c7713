// Messages on a byte stream: each preceded by its length as a varint, as every protobuf runtime
// reads and writes it.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sweepcast::frame {

/// Appends `length` as a varint, at most five bytes.
void append_length(std::vector<std::uint8_t>& out, std::uint32_t length);

/// Appends `message` with its length in front. At most 4 GiB - 1 bytes.
void append_delimited(std::vector<std::uint8_t>& out, std::span<const std::uint8_t> message);

/// Cuts a byte stream into its messages. The stream is hostile: memory is never taken on the word
/// of a length, only for bytes that have come, and a length beyond the limit is refused as soon as
/// it shows.
class DelimitedReader {
public:
    /// Refuses messages longer than `longest` bytes.
    explicit DelimitedReader(std::uint32_t longest) : longest_(longest) {}

    /// Takes the next bytes of the stream, cut anywhere. Call next() until it gives nothing before
    /// the next push(): then no more than one message and one push is held.
    void push(std::span<const std::uint8_t> bytes);

    /// The next message, valid until the next push(); none if more bytes are needed. An error is
    /// final: the boundary of the next message is lost. Errors: errc::length_malformed (longer than
    /// five bytes or than needed), errc::message_too_long.
    Result<std::optional<std::span<const std::uint8_t>>> next();

private:
    std::uint32_t longest_;
    std::vector<std::uint8_t> buffer_;
    std::size_t consumed_{};  // bytes at the front of buffer_ that next() has given out
};

}  // namespace sweepcast::frame
