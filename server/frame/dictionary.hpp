// The zstd dictionary for short scans: compiled in, made by tests/dictionary from virtual lidars.
#pragma once

#include <cstdint>
#include <span>

namespace sweepcast::frame {

/// Its bytes, in zstd's own format.
[[nodiscard]] std::span<const std::uint8_t> dictionary_bytes();

/// What it is called by, in Hello, in frames and by zstd itself: another content, another id.
[[nodiscard]] std::uint32_t dictionary_id();

}  // namespace sweepcast::frame
