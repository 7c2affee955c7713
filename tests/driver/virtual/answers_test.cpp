// What a host asks and what a scanner answers, byte by byte: the dialogue of the vendor's SDK with
// an A1.
#include "tests/driver/virtual/fake_host.hpp"
#include "tests/driver/virtual/hex.hpp"

#include <gtest/gtest.h>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;

struct Dialogue {
    const char* name;
    const char* request;
    const char* answer;  ///< empty: silence
};
void PrintTo(const Dialogue& dialogue, std::ostream* out) {
    *out << dialogue.name;
}

class Answers : public testing::TestWithParam<Dialogue> {};

TEST_P(Answers, AreThoseOfARealScanner) {
    FakeHost host;
    host.send(from_hex(GetParam().request));
    host.run(10ms);
    EXPECT_EQ(host.received(), from_hex(GetParam().answer));
}

const auto name_of = [](const auto& test) { return std::string(test.param.name); };

// In the order in which the vendor's SDK 2.1 asks (protocol.md 4).
INSTANTIATE_TEST_SUITE_P(
    VendorSdk,
    Answers,
    testing::Values(
        Dialogue{
            "info",
            "A5 50",
            "A5 5A 14 00 00 00 04 18 1D 01 07 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F 10"},
        Dialogue{"health", "A5 52", "A5 5A 03 00 00 00 06 00 00 00"},
        Dialogue{
            "model_name_alias",
            "A5 84 04 81 00 00 00 A4",
            "A5 5A 05 00 00 00 20 81 00 00 00 00"},
        Dialogue{
            "scan_mode_count",
            "A5 84 04 70 00 00 00 55",
            "A5 5A 06 00 00 00 20 70 00 00 00 03 00"},
        Dialogue{
            "duration_of_mode_0",
            "A5 84 06 71 00 00 00 00 00 56",
            "A5 5A 08 00 00 00 20 71 00 00 00 00 F4 01 00"},
        Dialogue{
            "range_of_mode_0",
            "A5 84 06 74 00 00 00 00 00 53",
            "A5 5A 08 00 00 00 20 74 00 00 00 00 0C 00 00"},
        Dialogue{
            "answer_type_of_mode_0",
            "A5 84 06 75 00 00 00 00 00 52",
            "A5 5A 05 00 00 00 20 75 00 00 00 81"},
        Dialogue{
            "name_of_mode_0",
            "A5 84 06 7F 00 00 00 00 00 58",
            "A5 5A 0D 00 00 00 20 7F 00 00 00 53 74 61 6E 64 61 72 64 00"},
        Dialogue{
            "duration_of_mode_1",
            "A5 84 06 71 00 00 00 01 00 57",
            "A5 5A 08 00 00 00 20 71 00 00 00 00 FA 00 00"},
        Dialogue{
            "range_of_mode_1",
            "A5 84 06 74 00 00 00 01 00 52",
            "A5 5A 08 00 00 00 20 74 00 00 00 00 0C 00 00"},
        Dialogue{
            "answer_type_of_mode_1",
            "A5 84 06 75 00 00 00 01 00 53",
            "A5 5A 05 00 00 00 20 75 00 00 00 82"},
        Dialogue{
            "name_of_mode_1",
            "A5 84 06 7F 00 00 00 01 00 59",
            "A5 5A 0C 00 00 00 20 7F 00 00 00 45 78 70 72 65 73 73 00"},
        Dialogue{
            "least_rotation",
            "A5 84 04 04 00 00 00 21",
            "A5 5A 06 00 00 00 20 04 00 00 00 2C 01"},
        Dialogue{
            "most_rotation",
            "A5 84 04 05 00 00 00 20",
            "A5 5A 06 00 00 00 20 05 00 00 00 84 03"},
        Dialogue{
            "desired_rotation",
            "A5 84 04 01 00 00 00 24",
            "A5 5A 08 00 00 00 20 01 00 00 00 58 02 94 02"},
        Dialogue{"stop", "A5 25", ""},
        Dialogue{
            "typical_mode",
            "A5 84 04 7C 00 00 00 59",
            "A5 5A 06 00 00 00 20 7C 00 00 00 01 00"},
        Dialogue{"express_scan", "A5 82 05 01 00 00 00 00 23", "A5 5A 54 00 00 40 82"},
        Dialogue{"scan", "A5 20", "A5 5A 05 00 00 40 81"}
    ),
    name_of
);

INSTANTIATE_TEST_SUITE_P(
    OtherHosts,
    Answers,
    testing::Values(
        Dialogue{"sample_rate", "A5 59", "A5 5A 04 00 00 00 15 F4 01 FA 00"},
        Dialogue{"legacy_express_scan", "A5 82 05 00 00 00 00 00 22", "A5 5A 54 00 00 40 82"},
        Dialogue{"motor_on", "A5 F0 02 94 02 C1", ""},
        Dialogue{"rpm_which_an_a1_does_not_know", "A5 A8 02 58 02 55", ""},
        Dialogue{"accessory_board_which_it_lacks", "A5 FF 04 00 00 00 00 5E", ""},
        Dialogue{
            "unknown_conf_echoes",
            "A5 84 04 99 00 00 00 BC",
            "A5 5A 04 00 00 00 20 99 00 00 00"},
        Dialogue{
            "conf_in_big_endian_echoes",
            "A5 84 04 00 00 00 70 55",
            "A5 5A 04 00 00 00 20 00 00 00 70"},
        Dialogue{
            "mode_it_lacks_echoes",
            "A5 84 06 71 00 00 00 03 00 55",
            "A5 5A 04 00 00 00 20 71 00 00 00"},
        Dialogue{
            "mode_that_is_not_given_echoes",
            "A5 84 04 71 00 00 00 54",
            "A5 5A 04 00 00 00 20 71 00 00 00"},
        Dialogue{"conf_cut_short", "A5 84 02 70 00 53", ""},
        Dialogue{
            "nothing_can_be_set",
            "A5 85 05 01 00 01 00 07 22",
            "A5 5A 08 00 00 00 21 01 00 01 00 04 80 00 80"},
        Dialogue{"express_of_a_standard_mode_it_lacks", "A5 82 05 07 00 00 00 00 25", ""},
        Dialogue{"express_cut_short", "A5 82 01 01 27", ""},
        Dialogue{"unknown_request", "A5 31", ""},
        Dialogue{"wrong_checksum", "A5 84 04 70 00 00 00 54", ""},
        Dialogue{"no_start_byte", "50 52 59", ""},
        Dialogue{"junk_before_a_request", "00 FF 5A 50 A5 52", "A5 5A 03 00 00 00 06 00 00 00"},
        Dialogue{"doubled_start_byte", "A5 A5 52", "A5 5A 03 00 00 00 06 00 00 00"}
    ),
    name_of
);

}  // namespace
}  // namespace sweepcast::virtual_lidar
