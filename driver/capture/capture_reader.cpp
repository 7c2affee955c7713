// Every length is checked before anything of that length is allocated.
#include "driver/capture/capture_reader.hpp"

#include "driver/protocol/wire.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <istream>
#include <span>
#include <string>

namespace sweepcast::capture {

namespace {

/// No capture goes on for longer, so that sums of times cannot overflow.
constexpr std::chrono::nanoseconds longest_capture = std::chrono::hours(24 * 365);

Problem unreadable(std::string cause, std::string hint) {
    return {
        make_error_code(boost::system::errc::invalid_argument),
        std::move(cause),
        std::move(hint)};
}

/// A line without its end; nullopt if there is none within `most` bytes.
std::optional<std::string> read_line(std::istream& in, std::size_t most) {
    std::string line;
    for (char c = 0; line.size() <= most && in.get(c);) {
        if (c == '\n') {
            return line;
        }
        line += c;
    }
    return std::nullopt;
}

/// Fills `into`; gives how many bytes there were.
std::size_t read_bytes(std::istream& in, std::span<std::uint8_t> into) {
    std::array<char, 4096> buffer{};
    std::size_t have = 0;
    while (have < into.size()) {
        const auto wanted = std::min(into.size() - have, buffer.size());
        in.read(buffer.data(), static_cast<std::streamsize>(wanted));
        const auto count = static_cast<std::size_t>(in.gcount());
        std::transform(
            buffer.begin(),
            buffer.begin() + static_cast<std::ptrdiff_t>(count),
            into.begin() + static_cast<std::ptrdiff_t>(have),
            [](char c) { return static_cast<std::uint8_t>(c); }
        );
        have += count;
        if (count < wanted) {
            break;
        }
    }
    return have;
}

struct RecordHead {
    Direction direction{};
    std::chrono::nanoseconds at{};
    std::size_t length{};
};

std::optional<RecordHead> parse_head(std::span<const std::uint8_t, record_head_bytes> bytes) {
    const auto direction = static_cast<Direction>(bytes[0]);
    const std::uint64_t time = protocol::load_le32(bytes.subspan<1, 4>()) |
                               std::uint64_t{protocol::load_le32(bytes.subspan<5, 4>())} << 32;
    const std::size_t length = protocol::load_le32(bytes.subspan<9, 4>());
    const bool known = direction == Direction::from_device || direction == Direction::to_device;
    if (!known || length == 0 || length > most_record_bytes ||
        time > static_cast<std::uint64_t>(longest_capture.count())) {
        return std::nullopt;
    }
    return RecordHead{direction, std::chrono::nanoseconds(static_cast<std::int64_t>(time)), length};
}

}  // namespace

bool is_capture(std::string_view bytes) {
    return bytes.starts_with(magic);
}

Result<CaptureReader, Problem> CaptureReader::open(std::istream& in) {
    const auto first = read_line(in, magic.size() + 8);
    if (!first || !is_capture(*first)) {
        return unreadable(
            "this is no capture of sweepcast",
            "make one with: sweepcast capture PORT -o FILE"
        );
    }
    if (first->substr(magic.size()) != std::to_string(version)) {
        return unreadable(
            fmt::format("this capture is of a version other than {}", version),
            "read it with the sweepcast that wrote it"
        );
    }
    const auto second = read_line(in, most_header_bytes);
    if (!second) {
        return unreadable("the header of the capture is cut short", "capture anew");
    }
    auto header = header_from_json(*second);
    if (!header) {
        return header.error();
    }
    return CaptureReader(in, std::move(*header));
}

std::optional<CaptureRecord> CaptureReader::next() {
    if (end_ != End::not_yet) {
        return std::nullopt;
    }
    std::array<std::uint8_t, record_head_bytes> bytes{};
    const auto have = read_bytes(*in_, bytes);
    if (have < bytes.size()) {
        end_ = have == 0 ? End::whole : End::cut_short;
        return std::nullopt;
    }
    const auto head = parse_head(bytes);
    if (!head || head->at < last_) {
        end_ = End::damaged;
        return std::nullopt;
    }
    CaptureRecord record{head->direction, head->at, std::vector<std::uint8_t>(head->length)};
    if (read_bytes(*in_, record.bytes) < record.bytes.size()) {
        end_ = End::cut_short;
        return std::nullopt;
    }
    last_ = head->at;
    return record;
}

}  // namespace sweepcast::capture
