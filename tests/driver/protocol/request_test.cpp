// Requests as a host writes them and as a scanner reads them.
#include "driver/protocol/request.hpp"

#include "driver/protocol/request_parser.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace sweepcast::protocol {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::microseconds;
using std::chrono::seconds;

struct RequestCase {
    std::string name;
    Request request;
    Bytes bytes;
};

class RequestTest : public testing::TestWithParam<RequestCase> {};

/// The requests that a parser finds in bytes that all arrive at once.
std::vector<Request> parse(const Bytes& bytes) {
    RequestParser parser;
    std::vector<Request> requests;
    for (const auto byte : bytes) {
        if (auto request = parser.push(byte, {})) {
            requests.push_back(*request);
        }
    }
    return requests;
}

TEST_P(RequestTest, IsWrittenAsTheProtocolSays) {
    EXPECT_EQ(encode(GetParam().request), GetParam().bytes);
}

TEST_P(RequestTest, IsReadBack) {
    EXPECT_EQ(parse(GetParam().bytes), std::vector{GetParam().request});
}

INSTANTIATE_TEST_SUITE_P(
    Known,
    RequestTest,
    testing::Values(
        RequestCase{"scan", {Command::scan}, {0xA5, 0x20}},
        RequestCase{"force_scan", {Command::force_scan}, {0xA5, 0x21}},
        RequestCase{"stop", {Command::stop}, {0xA5, 0x25}},
        RequestCase{"reset", {Command::reset}, {0xA5, 0x40}},
        RequestCase{"get_info", {Command::get_info}, {0xA5, 0x50}},
        RequestCase{"get_health", {Command::get_health}, {0xA5, 0x52}},
        RequestCase{"get_sample_rate", {Command::get_sample_rate}, {0xA5, 0x59}},
        RequestCase{"rpm_0", motor_rpm_request(0), {0xA5, 0xA8, 0x02, 0, 0, 0x0F}},
        RequestCase{
            "confirm_baud",
            confirm_baud_request(256000),
            {0xA5, 0x90, 0x08, 0x5F, 0x5F, 0x00, 0xE8, 0x03, 0x00, 0, 0, 0xD6}},
        RequestCase{
            "get_acc_board_flag",
            {Command::get_acc_board_flag, {0, 0, 0, 0}},
            {0xA5, 0xFF, 0x04, 0, 0, 0, 0, 0x5E}},
        RequestCase{"pwm_660", set_motor_pwm_request(660), {0xA5, 0xF0, 0x02, 0x94, 0x02, 0xC1}},
        RequestCase{"pwm_0", set_motor_pwm_request(0), {0xA5, 0xF0, 0x02, 0, 0, 0x57}},
        RequestCase{"rpm_600", motor_rpm_request(600), {0xA5, 0xA8, 0x02, 0x58, 0x02, 0x55}},
        RequestCase{
            "express_legacy",
            express_scan_request(0),
            {0xA5, 0x82, 0x05, 0, 0, 0, 0, 0, 0x22}},
        RequestCase{
            "express_mode_3",
            express_scan_request(3),
            {0xA5, 0x82, 0x05, 3, 0, 0, 0, 0, 0x21}},
        RequestCase{"empty_payload", {Command::get_lidar_conf}, {0xA5, 0x84, 0x00, 0x21}}
    ),
    [](const auto& tested) { return tested.param.name; }
);

TEST(RequestTest, APayloadOver255BytesIsTheCallersMistake) {
    EXPECT_THROW(
        (void)encode({Command::set_lidar_conf, Bytes(max_request_payload + 1)}),
        std::logic_error
    );
}

TEST(RequestTest, APayloadOnACommandThatCarriesNoneIsTheCallersMistake) {
    EXPECT_THROW((void)encode({Command::scan, {1}}), std::logic_error);
}

TEST(RequestTest, ThePayloadOfGreatestSizeIsReadBack) {
    std::mt19937 random(1);
    Request request{Command::set_lidar_conf, Bytes(max_request_payload)};
    for (auto& byte : request.payload) {
        byte = static_cast<std::uint8_t>(random());
    }
    EXPECT_EQ(parse(encode(request)), std::vector{request});
}

struct HiddenRequestCase {
    std::string name;
    Bytes bytes;
    std::vector<Command> found;
};

class RequestParserTest : public testing::TestWithParam<HiddenRequestCase> {};

TEST_P(RequestParserTest, FindsTheRequestsAmongOtherBytes) {
    std::vector<Command> commands;
    for (const auto& request : parse(GetParam().bytes)) {
        commands.push_back(request.command);
    }
    EXPECT_EQ(commands, GetParam().found);
}

INSTANTIATE_TEST_SUITE_P(
    Hidden,
    RequestParserTest,
    testing::Values(
        HiddenRequestCase{"after_noise", {0x00, 0x50, 0xFF, 0xA5, 0x50}, {Command::get_info}},
        HiddenRequestCase{"after_a_doubled_start", {0xA5, 0xA5, 0x50}, {Command::get_info}},
        HiddenRequestCase{
            "two_in_a_row",
            {0xA5, 0x25, 0xA5, 0x50},
            {Command::stop, Command::get_info}},
        HiddenRequestCase{"not_with_a_wrong_checksum", {0xA5, 0xF0, 0x02, 0, 0, 0x56}, {}},
        HiddenRequestCase{
            "after_a_wrong_checksum",
            {0xA5, 0xF0, 0x02, 0, 0, 0x56, 0xA5, 0x25},
            {Command::stop}},
        HiddenRequestCase{
            "whose_start_stands_for_a_checksum",
            {0xA5, 0xF0, 0x02, 0, 0, 0xA5, 0x25},
            {Command::stop}},
        HiddenRequestCase{"not_in_a_part", {0xA5, 0xF0, 0x02, 0x94}, {}}
    ),
    [](const auto& tested) { return tested.param.name; }
);

TEST(RequestParserTest, APartIsDroppedAfterFiveSeconds) {
    RequestParser parser;
    const SampleTime start{};
    EXPECT_EQ(parser.push(0xA5, start), std::nullopt);
    EXPECT_EQ(parser.push(0x50, start + request_time_limit + microseconds{1}), std::nullopt);
    EXPECT_EQ(parser.push(0xA5, start + seconds{6}), std::nullopt);
    EXPECT_EQ(parser.push(0x50, start + seconds{6}), Request{Command::get_info});
}

TEST(RequestParserTest, ARequestMayTakeFiveSeconds) {
    RequestParser parser;
    const SampleTime start{};
    EXPECT_EQ(parser.push(0xA5, start), std::nullopt);
    EXPECT_EQ(parser.push(0x50, start + request_time_limit), Request{Command::get_info});
}

}  // namespace
}  // namespace sweepcast::protocol
