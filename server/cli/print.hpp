// print(): how the commands print to a terminal.
#pragma once

#include "driver/protocol/printable.hpp"

#include <fmt/format.h>

#include <concepts>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

namespace sweepcast::cli {

/// Text that may hold line ends and escape sequences of our own, such as colours.
struct Trusted {
    std::string text;
};

/// Writes `text` as it is. Does not throw and does not report an error: the terminal may be gone,
/// and a lidar that scans must still be stopped.
void write_text(std::FILE* out, std::string_view text);

namespace print_detail {

template <class T>
concept Text = std::convertible_to<const T&, std::string_view>;

template <class T>
auto shown(const T& value) {
    if constexpr (Text<T>) {
        return protocol::printable(value);
    } else if constexpr (std::same_as<T, Trusted>) {
        return value.text;
    } else {
        return value;
    }
}

template <class T>
using Shown = decltype(shown(std::declval<const T&>()));

}  // namespace print_detail

/// Formats like fmt::format(), and makes every text among the arguments printable, whoever wrote
/// it. The format itself and Trusted arguments stay as they are.
template <class... Args>
std::string
format_printable(fmt::format_string<print_detail::Shown<Args>...> format, const Args&... args) {
    return fmt::format(format, print_detail::shown(args)...);
}

/// Writes what format_printable() returns; errors are ignored as by write_text().
template <class... Args>
void print(
    std::FILE* out,
    fmt::format_string<print_detail::Shown<Args>...> format,
    const Args&... args
) {
    write_text(out, format_printable(format, args...));
}

/// Writes a line of JSON, with or without a line end. It stays valid and means the same, because
/// only \u escapes of JSON replace characters in it.
void print_json_line(std::FILE* out, std::string_view line);

/// Returns `text` as a field of a CSV line: printable, and in quotes if it holds a comma or a quote
/// (RFC 4180).
std::string csv_field(std::string_view text);

}  // namespace sweepcast::cli
