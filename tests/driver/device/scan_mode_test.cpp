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

TEST(FastestMode, IsTheOneWithMostSamplesASecond) {
    EXPECT_EQ(fastest_mode(legacy_modes(firmware(1, 29), rate))->name, "Express");
    EXPECT_EQ(fastest_mode({}), nullptr);
}

TEST(ScanRequest, OfAnExpressModeIsTheLegacyOne) {
    const auto modes = legacy_modes(firmware(1, 29), rate);
    EXPECT_EQ(scan_request(modes[0]).command, protocol::Command::scan);
    EXPECT_EQ(scan_request(modes[1]), protocol::express_scan_request(0));
}

}  // namespace
}  // namespace sweepcast::device
