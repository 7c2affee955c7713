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
constexpr std::uint32_t first_low_surrogate = 0xDC00;
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

/// Characters that control a terminal, end a line, are invisible or change the direction of what
/// follows, in ascending order. Unless noted, those beyond C1 are Unicode's default-ignorable ones.
constexpr std::array<Range, 19> unsafe{{
    {0x0000, 0x001F},    // C0
    {0x007F, 0x009F},    // DEL, C1
    {0x00AD, 0x00AD},    // soft hyphen
    {0x034F, 0x034F},    // combining grapheme joiner
    {0x061C, 0x061C},    // Arabic letter mark
    {0x115F, 0x1160},    // Hangul fillers
    {0x17B4, 0x17B5},    // inherent vowels of Khmer
    {0x180B, 0x180F},    // Mongolian variation selectors
    {0x200B, 0x200F},    // zero-width characters, left-to-right and right-to-left mark
    {0x2028, 0x202E},    // line and paragraph separator (not ignorable), embeddings, overrides
    {0x2060, 0x206F},    // word joiner, invisible operators, isolates
    {0x3164, 0x3164},    // Hangul filler
    {0xFE00, 0xFE0F},    // variation selectors
    {0xFEFF, 0xFEFF},    // byte order mark
    {0xFFA0, 0xFFA0},    // halfwidth Hangul filler
    {0xFFF0, 0xFFFB},    // unassigned; annotation marks (not ignorable)
    {0x1BCA0, 0x1BCA3},  // shorthand format controls
    {0x1D173, 0x1D17A},  // musical format controls
    {0xE0000, 0xE0FFF},  // tags, variation selectors
}};

bool is_unsafe(std::uint32_t code) {
    const auto* const range = std::lower_bound(
        unsafe.begin(),
        unsafe.end(),
        code,
        [](const Range& each, std::uint32_t wanted) { return each.last < wanted; }
    );
    return range != unsafe.end() && code >= range->first;
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
        break;
    }
    constexpr std::uint32_t first_of_pairs = 0x10000;
    if (code >= first_of_pairs) {  // a surrogate pair, as JSON has it
        to += "\\u";
        append_hex(to, first_surrogate + ((code - first_of_pairs) >> 10U), 4);
        code = first_low_surrogate + ((code - first_of_pairs) & 0x3FFU);
    }
    to += "\\u";
    append_hex(to, code, 4);
}

/// Takes the first character off `from` and appends it to `to` in its printable form.
void move_character(std::string_view& from, std::string& to) {
    const auto next = read(from);
    if (next.size == 0) {
        to += "\\x";
        append_hex(to, byte_at(from, 0), 2);
    } else if (is_unsafe(next.code)) {
        append_escaped(to, next.code);
    } else {
        to += from.substr(0, next.size);
    }
    from.remove_prefix(std::max<std::size_t>(next.size, 1));
}

}  // namespace

std::string printable(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    while (!text.empty()) {
        move_character(text, result);
    }
    return result;
}

std::string printable_start(std::string_view text, std::size_t most, std::string_view mark) {
    std::string result;
    while (!text.empty()) {
        const auto size = result.size();
        move_character(text, result);
        if (result.size() > most) {
            result.resize(size);
            result += mark;
            break;
        }
    }
    return result;
}

}  // namespace sweepcast::protocol
