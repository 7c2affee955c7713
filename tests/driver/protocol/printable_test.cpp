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
        PrintableCase{
            "zero_width",
            "a\xe2\x80\x8b\xe2\x80\x8c\xe2\x80\x8d\xe2\x81\xa0",
            "a\\u200b\\u200c\\u200d\\u2060"},
        PrintableCase{"soft_hyphen", "a\xc2\xad", "a\\u00ad"},
        PrintableCase{"filler", "a\xe3\x85\xa4", "a\\u3164"},
        PrintableCase{"variation_selector", "a\xef\xb8\x8f", "a\\ufe0f"},
        PrintableCase{"tags", "\xf3\xa0\x80\x81\xf3\xa0\x81\xbf", "\\udb40\\udc01\\udb40\\udc7f"},
        PrintableCase{"visible_beside_invisible", "\xe2\x80\x90\xe2\x81\xb0", "\u2010\u2070"},
        PrintableCase{"json", R"({"a": "b\n\u0001"})", R"({"a": "b\n\u0001"})"},
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

TEST(PrintableStart, ReturnsAShortTextWholeAndWithoutTheMark) {
    EXPECT_EQ(printable_start("", 3, "..."), "");
    EXPECT_EQ(printable_start("abc", 3, "..."), "abc");
    EXPECT_EQ(printable_start("\x1b", 6, "..."), "\\u001b");
}

TEST(PrintableStart, EndsALongTextWithTheMark) {
    EXPECT_EQ(printable_start("abcd", 3, "..."), "abc...");
    EXPECT_EQ(printable_start("abcd", 3), "abc");
}

TEST(PrintableStart, CutsNoCharacter) {
    EXPECT_EQ(printable_start("aé", 2, "..."), "a...");
    EXPECT_EQ(printable_start("🤖", 3, "..."), "...");
}

TEST(PrintableStart, CountsAndCutsNoEscape) {
    EXPECT_EQ(printable_start("\x1b\x1b", 11, "..."), "\\u001b...");
    EXPECT_EQ(printable_start("\xff\xff", 7, "..."), "\\xff...");
}

}  // namespace
}  // namespace sweepcast::protocol
