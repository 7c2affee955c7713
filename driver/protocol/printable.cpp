#include "driver/protocol/printable.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace sweepcast::protocol {

namespace {

/// The character at the beginning of a text.
struct Character {
    std::uint32_t code{};
    std::size_t size{};  ///< in bytes; 0: the first byte is not part of valid UTF-8
};

constexpr std::uint32_t first_surrogate = 0xD800;
constexpr std::uint32_t last_surrogate = 0xDFFF;
constexpr std::uint32_t last_code = 0x10FFFF;

std::uint8_t byte_at(std::string_view text, std::size_t index) {
    return static_cast<std::uint8_t>(text[index]);
}

/// Reads a character of `size` bytes. The lead byte holds the bits `mask` of its code, which is at
/// least `least` unless more bytes than needed encode it.
Character
read_long(std::string_view text, std::size_t size, std::uint32_t mask, std::uint32_t least) {
    if (text.size() < size) {
        return {};
    }
    std::uint32_t code = byte_at(text, 0) & mask;
    for (std::size_t i = 1; i < size; ++i) {
        const auto byte = byte_at(text, i);
        if ((byte & 0xC0U) != 0x80) {
            return {};
        }
        code = (code << 6U) | (byte & 0x3FU);
    }
    const bool surrogate = code >= first_surrogate && code <= last_surrogate;
    return code < least || code > last_code || surrogate ? Character{} : Character{code, size};
}

Character read(std::string_view text) {
    const auto lead = byte_at(text, 0);
    if (lead < 0x80) {
        return {lead, 1};
    }
    if ((lead & 0xE0U) == 0xC0) {
        return read_long(text, 2, 0x1F, 0x80);
    }
    if ((lead & 0xF0U) == 0xE0) {
        return read_long(text, 3, 0x0F, 0x800);
    }
    if ((lead & 0xF8U) == 0xF0) {
        return read_long(text, 4, 0x07, 0x10000);
    }
    return {};
}

struct Range {
    std::uint32_t first{}, last{};
};

/// Characters that control a terminal, end a line or change the direction of what follows.
constexpr std::array<Range, 7> unsafe{{
    {0x0000, 0x001F},  // C0
    {0x007F, 0x009F},  // DEL, C1
    {0x061C, 0x061C},  // Arabic letter mark
    {0x200E, 0x200F},  // left-to-right and right-to-left mark
    {0x2028, 0x202E},  // line and paragraph separator, embeddings and overrides
    {0x2066, 0x2069},  // isolates
    {0xFEFF, 0xFEFF},  // byte order mark: invisible
}};

bool is_unsafe(std::uint32_t code) {
    return std::any_of(unsafe.begin(), unsafe.end(), [code](const Range& range) {
        return code >= range.first && code <= range.last;
    });
}

void append_hex(std::string& to, std::uint32_t value, std::size_t digits) {
    constexpr std::string_view hex = "0123456789abcdef";
    while (digits > 0) {
        --digits;
        to += hex[(value >> (4 * digits)) & 0xFU];
    }
}

void append_escaped(std::string& to, std::uint32_t code) {
    switch (code) {
    case '\n':
        to += "\\n";
        return;
    case '\r':
        to += "\\r";
        return;
    case '\t':
        to += "\\t";
        return;
    default:
        to += "\\u";
        append_hex(to, code, 4);
    }
}

}  // namespace

std::string printable(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    while (!text.empty()) {
        const auto next = read(text);
        if (next.size == 0) {
            result += "\\x";
            append_hex(result, byte_at(text, 0), 2);
        } else if (is_unsafe(next.code)) {
            append_escaped(result, next.code);
        } else {
            result += text.substr(0, next.size);
        }
        text.remove_prefix(std::max<std::size_t>(next.size, 1));
    }
    return result;
}

}  // namespace sweepcast::protocol
