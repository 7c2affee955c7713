#include "driver/capture/capture_writer.hpp"

#include "driver/protocol/wire.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ostream>

namespace sweepcast::capture {

namespace {

std::array<std::uint8_t, record_head_bytes>
head_of(Direction direction, std::chrono::nanoseconds at, std::size_t length) {
    std::array<std::uint8_t, record_head_bytes> head{};
    const std::span bytes(head);
    const auto time = static_cast<std::uint64_t>(at.count());
    head[0] = static_cast<std::uint8_t>(direction);
    protocol::store_le32(bytes.subspan<1, 4>(), static_cast<std::uint32_t>(time));
    protocol::store_le32(bytes.subspan<5, 4>(), static_cast<std::uint32_t>(time >> 32));
    protocol::store_le32(bytes.subspan<9, 4>(), static_cast<std::uint32_t>(length));
    return head;
}

}  // namespace

CaptureWriter::CaptureWriter(std::ostream& out, const CaptureHeader& header) : out_(&out) {
    *out_ << magic << version << '\n' << to_json(header) << '\n' << std::flush;
}

bool CaptureWriter::append(
    Direction direction,
    std::chrono::nanoseconds at,
    std::span<const std::uint8_t> bytes
) {
    last_ = std::max(last_, at);
    while (!bytes.empty() && ok()) {
        const auto now = bytes.first(std::min(bytes.size(), most_record_bytes));
        write(head_of(direction, last_, now.size()));
        write(now);
        bytes = bytes.subspan(now.size());
    }
    out_->flush();
    return ok();
}

bool CaptureWriter::ok() const {
    return out_->good();
}

void CaptureWriter::write(std::span<const std::uint8_t> bytes) {
    for (const auto byte : bytes) {
        out_->put(static_cast<char>(byte));
    }
}

}  // namespace sweepcast::capture
