// Bytes as a person writes them.
#pragma once

#include <charconv>
#include <cstdint>
#include <string_view>
#include <vector>

namespace sweepcast::virtual_lidar {

/// Reads "A5 50".
inline std::vector<std::uint8_t> from_hex(std::string_view text) {
    std::vector<std::uint8_t> bytes;
    while (text.size() >= 2) {
        if (text.front() != ' ') {
            bytes.push_back(0);
            std::from_chars(text.data(), text.data() + 2, bytes.back(), 16);
            text.remove_prefix(2);
        }
        text.remove_prefix(text.empty() ? 0 : 1);
    }
    return bytes;
}

}  // namespace sweepcast::virtual_lidar
