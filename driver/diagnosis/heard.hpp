// Heard: what came over a line while one listened, told apart by its look: an answer, scan data,
// boot text or noise. For finding out what is wrong; pure.
#pragma once

#include "driver/protocol/reply.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sweepcast::diagnosis {

/// Each tells more than the one before it.
enum class HeardKind : std::uint8_t {
    nothing,
    noise,      ///< bytes without a meaning: a wrong line speed, a bad cable, another device
    text,       ///< printable, but not from a lidar
    boot_text,  ///< what a lidar prints when it gets its power or was reset (protocol.md 11.2)
    scan_data,  ///< packets of a measurement stream
    answer,     ///< to GET_INFO
};

[[nodiscard]] std::string_view name(HeardKind kind);

struct Heard {
    std::uint32_t baud{};  ///< the line speed listened at; 0: a network
    bool possible{true};   ///< the adapter can run at this speed
    HeardKind kind{};
    std::size_t bytes{};
    std::string text;     ///< of text and boot_text: the beginning of it, printable ASCII only
    std::size_t boots{};  ///< how many times boot text began
    /// Of an answer that came whole.
    std::optional<protocol::DeviceInfo> info;
};

/// Tells what `bytes`, the first that were heard at `baud`, are. Scan data is what one of the
/// decoders turns into samples nearly without a rest; noise passes for it less than once in
/// ten thousand times (measured over random bytes).
[[nodiscard]] Heard classify(std::uint32_t baud, std::span<const std::uint8_t> bytes);

}  // namespace sweepcast::diagnosis
