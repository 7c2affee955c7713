// SourceStream: a ByteSource for those who want a stream.
#pragma once

#include "server/cli/byte_source.hpp"

#include <istream>
#include <optional>
#include <streambuf>
#include <vector>

namespace sweepcast::cli {

/// Holds one block at a time. `source` outlives it.
class SourceStream final : public std::istream {
public:
    explicit SourceStream(ByteSource& source);

    /// Why the source could not be read to its end, if so; the stream has ended there.
    [[nodiscard]] const std::optional<Problem>& problem() const { return buffer_.problem; }

private:
    struct Buffer final : std::streambuf {
        explicit Buffer(ByteSource& from) : source(from) {}
        int_type underflow() override;

        ByteSource& source;
        std::vector<char> block;
        std::optional<Problem> problem;
    };

    Buffer buffer_;
};

}  // namespace sweepcast::cli
