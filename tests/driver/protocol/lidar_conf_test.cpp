// Configuration requests and the answers to them.
#include "driver/protocol/lidar_conf.hpp"

#include "driver/protocol/error.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::protocol {
namespace {

using Bytes = std::vector<std::uint8_t>;
using namespace std::chrono_literals;

Bytes text(std::string_view characters) {
    return {characters.begin(), characters.end()};
}

TEST(ConfRequestTest, CarriesTheTypeAndTheMode) {
    EXPECT_EQ(
        encode(get_conf_request(ConfType::typical_mode)),
        (Bytes{0xA5, 0x84, 0x04, 0x7C, 0, 0, 0, 0x59})
    );
    EXPECT_EQ(
        encode(get_mode_conf_request(ConfType::mode_name, 1)),
        (Bytes{0xA5, 0x84, 0x06, 0x7F, 0, 0, 0, 1, 0, 0x59})
    );
}

TEST(ConfRequestTest, SetsAnAddress) {
    const StaticIp ip{{192, 168, 11, 2}, {255, 255, 255, 0}, {192, 168, 11, 1}};
    const auto request = set_conf_request(ConfType::static_ip, encode_static_ip(ip));
    EXPECT_EQ(request.command, Command::set_lidar_conf);
    EXPECT_EQ(
        request.payload,
        (Bytes{0xC0, 0xCC, 0x01, 0, 192, 168, 11, 2, 255, 255, 255, 0, 192, 168, 11, 1})
    );
    EXPECT_EQ(decode_static_ip(std::span(request.payload).subspan(4)).value(), ip);
}

TEST(ConfAnswerTest, IsWhatFollowsTheEcho) {
    const Bytes packet{0x70, 0, 0, 0, 5, 0};
    EXPECT_EQ(decode_conf_u16(decode_conf(packet, ConfType::scan_mode_count).value()).value(), 5);
}

TEST(ConfAnswerTest, ABareEchoMeansNotSupported) {
    const Bytes packet{0x79, 0, 0, 0};
    EXPECT_EQ(decode_conf(packet, ConfType::mac_address).error(), errc::conf_not_supported);
}

TEST(ConfAnswerTest, AnotherQuestionsAnswerIsRefused) {
    const Bytes packet{0x70, 0, 0, 0, 5, 0};
    EXPECT_EQ(decode_conf(packet, ConfType::typical_mode).error(), errc::conf_type_mismatch);
}

TEST(ConfAnswerTest, TooShortForAnEchoIsRefused) {
    for (std::size_t size = 0; size < 4; ++size) {
        EXPECT_EQ(
            decode_conf(Bytes(size), ConfType::typical_mode).error(),
            errc::length_out_of_range
        );
    }
}

TEST(ConfAnswerTest, ValuesTooShortForTheirMeaningAreRefused) {
    EXPECT_EQ(decode_conf_u16(Bytes(1)).error(), errc::length_out_of_range);
    EXPECT_EQ(decode_desired_rotation(Bytes(3)).error(), errc::length_out_of_range);
    EXPECT_EQ(decode_mode_sample_duration(Bytes(3)).error(), errc::length_out_of_range);
    EXPECT_EQ(decode_mode_max_distance(Bytes(3)).error(), errc::length_out_of_range);
    EXPECT_EQ(decode_mode_answer_type(Bytes{}).error(), errc::length_out_of_range);
    EXPECT_EQ(decode_static_ip(Bytes(11)).error(), errc::length_out_of_range);
}

TEST(ConfAnswerTest, DurationsAndDistancesAreInUnitsOf256) {
    EXPECT_EQ(decode_mode_sample_duration(Bytes{0, 0xFA, 0, 0}).value(), 250us);
    EXPECT_EQ(decode_mode_sample_duration(Bytes{0x40, 0x1F, 0, 0}).value(), 31250ns);
    EXPECT_EQ(decode_mode_sample_duration(Bytes{0, 0, 0, 0}).value(), 0ns);
    EXPECT_EQ(decode_mode_max_distance(Bytes{0, 12, 0, 0}).value(), 12000.0);
    EXPECT_EQ(decode_mode_max_distance(Bytes{0xFF, 0xFF, 0xFF, 0xFF}).value(), 0xFFFFFFFF / 0.256);
}

TEST(ConfAnswerTest, DesiredRotationIsSpeedAndDuty) {
    EXPECT_EQ(
        decode_desired_rotation(Bytes{0x58, 0x02, 0x94, 0x02}).value(),
        (DesiredRotation{600, 660})
    );
}

TEST(ConfTextTest, EndsAtAZeroOrWithoutOne) {
    EXPECT_EQ(decode_conf_text(text(std::string_view("Boost\0x", 7))).value(), "Boost");
    EXPECT_EQ(decode_conf_text(text("Boost")).value(), "Boost");
    EXPECT_EQ(decode_conf_text({}).value(), "");
}

TEST(ConfTextTest, HoldsAtMost64PrintableCharacters) {
    EXPECT_EQ(decode_conf_text(text(std::string(200, 'x'))).value().size(), 64U);
    EXPECT_EQ(decode_conf_text(text("a\x1B[2Jb\xFF")).value(), "a[2Jb");
}

TEST(SetConfAnswerTest, SaysWhetherItTookEffect) {
    const Bytes taken{0xC0, 0xCC, 0x01, 0, 0, 0, 0, 0};
    const Bytes refused{0xC0, 0xCC, 0x01, 0, 0x04, 0x80, 0x00, 0x80};
    EXPECT_TRUE(decode_set_conf(taken, ConfType::static_ip));
    EXPECT_EQ(decode_set_conf(refused, ConfType::static_ip).error(), errc::conf_refused);
    EXPECT_EQ(decode_set_conf(taken, ConfType::typical_mode).error(), errc::conf_type_mismatch);
    EXPECT_EQ(
        decode_set_conf(std::span(taken).first(4), ConfType::static_ip).error(),
        errc::length_out_of_range
    );
}

}  // namespace
}  // namespace sweepcast::protocol
