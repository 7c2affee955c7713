// Text as people write it, without what they cannot see.
#pragma once

#include <string_view>

namespace sweepcast::virtual_lidar {

/// What separates words.
inline constexpr std::string_view blanks = " \t\r\n";

/// The text without the blanks round it.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

}  // namespace sweepcast::virtual_lidar
