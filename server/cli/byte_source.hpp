// ByteSource: where `sweepcast decode` has its bytes from.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sweepcast::cli {

/// Bytes, block by block. Blocking; holds one block at a time, however long the input.
class ByteSource {
public:
    virtual ~ByteSource() = default;

    /// The next block as soon as there is one, valid until the next call; empty at the end.
    virtual Result<std::span<const std::uint8_t>, Problem> next() = 0;
};

/// The bytes of a file, pipe or device as they are; "-" is standard input.
[[nodiscard]] Result<std::unique_ptr<ByteSource>, Problem> open_byte_source(const std::string& path
);

/// A source whose beginning can be looked at before it is read.
class PeekSource final : public ByteSource {
public:
    explicit PeekSource(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {}

    /// Whether the source begins with `text`. Reads no further than it takes to tell. To be called
    /// before next().
    Result<bool, Problem> begins_with(std::string_view text);

    Result<std::span<const std::uint8_t>, Problem> next() override;

private:
    std::unique_ptr<ByteSource> source_;
    std::vector<std::uint8_t> seen_;  ///< still to be given
    std::vector<std::uint8_t> given_;
};

}  // namespace sweepcast::cli
