// ByteSource: where `sweepcast decode` has its bytes from.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>

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

}  // namespace sweepcast::cli
