// What printable() escapes, and what it leaves alone.
#include "driver/protocol/printable.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace sweepcast::protocol {
namespace {

using namespace std::string_literals;

struct PrintableCase {
    const char* name;
    std::string text;
    std::string_view shown;
};

class PrintableTest : public testing::TestWithParam<PrintableCase> {};

TEST_P(PrintableTest, EscapesWhatATerminalWouldObey) {
    EXPECT_EQ(printable(GetParam().text), GetParam().shown);
}

TEST_P(PrintableTest, LeavesItsOwnResultAlone) {
    EXPECT_EQ(printable(GetParam().shown), GetParam().shown);
}

INSTANTIATE_TEST_SUITE_P(
    Texts,
    PrintableTest,
    testing::Values(
        PrintableCase{"empty", "", ""},
        PrintableCase{"ascii", "A1M8 (10c4:ea60) \"x\" \\n ~", "A1M8 (10c4:ea60) \"x\" \\n ~"},
        PrintableCase{"utf8", "Küche 厨房 🤖", "Küche 厨房 🤖"},
        PrintableCase{"c0", "\x1b[2J\x01\0\x07"s, "\\u001b[2J\\u0001\\u0000\\u0007"},
        PrintableCase{"line_ends", "a\r\nb\tc", "a\\r\\nb\\tc"},
        PrintableCase{"del", "a\x7f", "a\\u007f"},
        PrintableCase{"c1_as_utf8", "\xc2\x9b[2J\xc2\x85", "\\u009b[2J\\u0085"},
        PrintableCase{"c1_as_bytes", "\x9b[2J\x85", "\\x9b[2J\\x85"},
        PrintableCase{"no_break_space_stays", "a\xc2\xa0", "a\xc2\xa0"},
        PrintableCase{
            "override",
            "a\xe2\x80\xae"
            "b\xe2\x80\xac",
            "a\\u202eb\\u202c"},
        PrintableCase{
            "isolate",
            "\xe2\x81\xa6"
            "a\xe2\x81\xa9",
            "\\u2066a\\u2069"},
        PrintableCase{"marks", "\xe2\x80\x8e\xe2\x80\x8f\xd8\x9c", "\\u200e\\u200f\\u061c"},
        PrintableCase{"separators", "\xe2\x80\xa8\xe2\x80\xa9", "\\u2028\\u2029"},
        PrintableCase{
            "byte_order_mark",
            "\xef\xbb\xbf"
            "a",
            "\\ufeffa"},
        PrintableCase{"lone_continuation", "a\x80", "a\\x80"},
        PrintableCase{"cut_short", "\xf0\x9f\xa4", "\\xf0\\x9f\\xa4"},
        PrintableCase{
            "interrupted",
            "\xe2\x80"
            "a",
            "\\xe2\\x80a"},
        PrintableCase{"overlong_escape", "\xc0\x9b", "\\xc0\\x9b"},
        PrintableCase{"overlong_three", "\xe0\x80\x9b", "\\xe0\\x80\\x9b"},
        PrintableCase{"surrogate", "\xed\xa0\x80", "\\xed\\xa0\\x80"},
        PrintableCase{"beyond_unicode", "\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80"},
        PrintableCase{"never_utf8", "\xfe\xff", "\\xfe\\xff"}
    ),
    [](const auto& test) { return test.param.name; }
);

}  // namespace
}  // namespace sweepcast::protocol
