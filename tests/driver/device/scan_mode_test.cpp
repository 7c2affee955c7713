// Scan modes: which there are, how they are found and asked for.
#include "driver/device/scan_mode.hpp"

#include <gtest/gtest.h>

namespace sweepcast::device {
namespace {

using namespace std::chrono_literals;

constexpr protocol::SampleRate rate{500us, 250us};

protocol::DeviceInfo firmware(std::uint8_t major, std::uint8_t minor) {
    protocol::DeviceInfo info;
    info.firmware_major = major;
    info.firmware_minor = minor;
    return info;
}

TEST(LegacyModes, FirmwareBefore117HasNoExpress) {
    const auto modes = legacy_modes(firmware(1, 16), rate);
    ASSERT_EQ(modes.size(), 1U);
    EXPECT_EQ(modes[0].name, "Standard");
}

TEST(LegacyModes, FirmwareFrom117OnHasStandardAndExpress) {
    const auto modes = legacy_modes(firmware(1, 17), rate);
    ASSERT_EQ(modes.size(), 2U);
    EXPECT_EQ(modes[0].samples_per_second(), 2000);
    EXPECT_EQ(modes[1].samples_per_second(), 4000);
    EXPECT_EQ(modes[1].answer_type, protocol::AnswerType::express);
}

TEST(FindMode, TakesNoNoticeOfCase) {
    const auto modes = legacy_modes(firmware(1, 29), rate);
    ASSERT_NE(find_mode(modes, "eXPRESS"), nullptr);
    EXPECT_EQ(find_mode(modes, "eXPRESS")->name, "Express");
    EXPECT_EQ(find_mode(modes, "Expres"), nullptr);
    EXPECT_EQ(find_mode(modes, ""), nullptr);
}

TEST(FindMode, TakesAnIdToo) {
    auto modes = legacy_modes(firmware(1, 29), rate);
    EXPECT_EQ(find_mode(modes, "1"), nullptr) << "modes that nobody listed have no ids";
    modes[1].id = 1;
    EXPECT_EQ(find_mode(modes, "1"), &modes[1]);
    EXPECT_EQ(find_mode(modes, "01"), nullptr);
}

TEST(BestMode, IsTheOneWithMostSamplesASecond) {
    EXPECT_EQ(best_mode(legacy_modes(firmware(1, 29), rate))->name, "Express");
    EXPECT_EQ(best_mode({}), nullptr);
}

TEST(BestMode, IsTheTypicalOneIfThereIsOne) {
    auto modes = legacy_modes(firmware(1, 29), rate);
    modes[0].typical = true;
    EXPECT_EQ(best_mode(modes)->name, "Standard");
}

TEST(ScanRequest, NamesTheIdOfAListedMode) {
    const ScanMode mode{
        .name = "Boost",
        .answer_type = protocol::AnswerType::ultra,
        .sample_duration = 63us,
        .id = 2};
    EXPECT_EQ(scan_request(mode), protocol::express_scan_request(2));
}

TEST(ScanRequest, OfANormalModeIsNeverAnExpressOne) {
    const ScanMode mode{
        .name = "Standard",
        .answer_type = protocol::AnswerType::normal,
        .sample_duration = 500us,
        .id = 3};
    EXPECT_EQ(scan_request(mode).command, protocol::Command::scan);
}

TEST(ScanRequest, OfAnExpressModeIsTheLegacyOne) {
    const auto modes = legacy_modes(firmware(1, 29), rate);
    EXPECT_EQ(scan_request(modes[0]).command, protocol::Command::scan);
    EXPECT_EQ(scan_request(modes[1]), protocol::express_scan_request(0));
}

}  // namespace
}  // namespace sweepcast::device
