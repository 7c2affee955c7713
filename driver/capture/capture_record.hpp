// What a capture file holds, and its limits.
//
// A capture is two lines of text and then records, up to the end of the file:
//
//     sweepcast capture 1\n
//     {"model":"A1M8", ...}\n                 see CaptureHeader
//     record: direction (1 byte: '<' from the device, '>' to it),
//             time (8 bytes: nanoseconds since the capture began, never less than in the record
//             before), length (4 bytes: 1 to most_record_bytes), and so many bytes as they were on
//             the line
//
// Numbers are little endian. A file may end anywhere: whoever wrote it was stopped, or the disk was
// full. What is whole counts.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace sweepcast::capture {

/// How every capture begins, before the version's number.
inline constexpr std::string_view magic = "sweepcast capture ";
inline constexpr int version = 1;
inline constexpr std::size_t most_header_bytes = 16384;
inline constexpr std::size_t record_head_bytes = 13;
inline constexpr std::size_t most_record_bytes = 65536;

enum class Direction : std::uint8_t {
    from_device = '<',
    to_device = '>',
};

struct CaptureRecord {
    Direction direction{};
    std::chrono::nanoseconds at{};  ///< since the capture began
    std::vector<std::uint8_t> bytes;
    bool operator==(const CaptureRecord&) const = default;
};

}  // namespace sweepcast::capture
