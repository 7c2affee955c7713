#include "server/cli/source_stream.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::cli {

SourceStream::SourceStream(ByteSource& source) : std::istream(nullptr), buffer_(source) {
    rdbuf(&buffer_);
}

SourceStream::Buffer::int_type SourceStream::Buffer::underflow() {
    const auto bytes = source.next();
    if (!bytes) {
        problem = bytes.error();
        return traits_type::eof();
    }
    if (bytes->empty()) {
        return traits_type::eof();
    }
    block.resize(bytes->size());
    std::ranges::transform(*bytes, block.begin(), [](auto byte) {
        return static_cast<char>(byte);
    });
    setg(block.data(), block.data(), block.data() + block.size());
    return traits_type::to_int_type(block.front());
}

}  // namespace sweepcast::cli
