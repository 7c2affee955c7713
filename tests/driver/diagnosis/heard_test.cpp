// What was heard on a line is told apart by its look.
#include "driver/diagnosis/heard.hpp"

#include "driver/protocol/descriptor_hunter.hpp"
#include "driver/protocol/encode_express.hpp"
#include "driver/protocol/encode_normal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::diagnosis {
namespace {

using testing::HasSubstr;
using testing::Not;
using Bytes = std::vector<std::uint8_t>;

constexpr std::string_view boot_text =
    "RP LIDAR System.\r\nFirmware Ver 1.25 - rc2, HW Ver 5\r\nModel: 18\r\n";

Bytes bytes_of(std::string_view text) {
    return {text.begin(), text.end()};
}

Bytes random_bytes(std::mt19937& random, std::size_t count) {
    Bytes bytes(count);
    for (auto& byte : bytes) {
        byte = static_cast<std::uint8_t>(random());
    }
    return bytes;
}

/// Packets of 0x81, a degree apart.
Bytes normal_scan(int packets) {
    Bytes bytes;
    for (int i = 0; i < packets; ++i) {
        protocol::NormalMeasurement measurement;
        measurement.angle = protocol::AngleQ6{static_cast<std::uint16_t>(i * 64)};
        measurement.distance_q2 = static_cast<std::uint16_t>(4000 + 7 * i);
        const auto packet = protocol::encode_normal(measurement);
        bytes.insert(bytes.end(), packet.begin(), packet.end());
    }
    return bytes;
}

Bytes express_scan(int capsules) {
    Bytes bytes;
    for (int i = 0; i < capsules; ++i) {
        protocol::ExpressCapsule capsule;
        capsule.start_angle = protocol::AngleQ6{static_cast<std::uint16_t>(i * 64 * 20)};
        const auto packet = protocol::encode_express(capsule);
        bytes.insert(bytes.end(), packet.begin(), packet.end());
    }
    return bytes;
}

Bytes answer(const protocol::DeviceInfo& info) {
    const auto descriptor = protocol::encode_descriptor({protocol::device_info_size, false, 4});
    const auto payload = protocol::encode_device_info(info);
    Bytes bytes(descriptor.begin(), descriptor.end());
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    return bytes;
}

TEST(Heard, SilenceIsNothing) {
    EXPECT_EQ(classify(115200, {}).kind, HeardKind::nothing);
}

TEST(Heard, AnAnswerTellsWhoItIsFrom) {
    protocol::DeviceInfo info;
    info.model = 0x2C;
    auto bytes = bytes_of("leftovers");
    const auto answered = answer(info);
    bytes.insert(bytes.end(), answered.begin(), answered.end());
    const auto heard = classify(256000, bytes);
    EXPECT_EQ(heard.kind, HeardKind::answer);
    EXPECT_EQ(heard.baud, 256000U);
    ASSERT_TRUE(heard.info);
    EXPECT_EQ(*heard.info, info);
}

TEST(Heard, AnAnswerThatBreaksOffIsOneWithoutInfo) {
    auto bytes = answer({});
    bytes.pop_back();
    const auto heard = classify(115200, bytes);
    EXPECT_EQ(heard.kind, HeardKind::answer);
    EXPECT_FALSE(heard.info);
}

TEST(Heard, BootTextIsQuotedOnOneLineAndCounted) {
    auto bytes = bytes_of(boot_text);
    bytes.insert(bytes.begin(), {0x00, 0xC3, 0x80});  // the line coming up
    const auto again = bytes_of(boot_text);
    bytes.insert(bytes.end(), again.begin(), again.end());
    const auto heard = classify(115200, bytes);
    EXPECT_EQ(heard.kind, HeardKind::boot_text);
    EXPECT_EQ(heard.boots, 2U);
    EXPECT_THAT(heard.text, HasSubstr("RP LIDAR System. / Firmware Ver 1.25 - rc2"));
    EXPECT_THAT(heard.text, Not(HasSubstr("\n")));
}

TEST(Heard, OfLongTextOnlyTheBeginningIsQuoted) {
    const auto heard = classify(115200, bytes_of("$GPGGA" + std::string(10'000, '1')));
    EXPECT_EQ(heard.kind, HeardKind::text);
    EXPECT_EQ(heard.text, "$GPGGA" + std::string(74, '1'));
}

TEST(Heard, TextOfAnotherDeviceIsNotBootText) {
    const auto heard = classify(115200, bytes_of("$GPGGA,123519,4807.038,N,01131.000,E,1,08\r\n"));
    EXPECT_EQ(heard.kind, HeardKind::text);
    EXPECT_THAT(heard.text, HasSubstr("$GPGGA"));
}

TEST(Heard, ScanDataIsKnownFromAnywhereInAPacket) {
    for (const auto& scan : {normal_scan(60), express_scan(12)}) {
        for (const std::size_t cut : {0U, 3U, 41U}) {
            const auto part = std::span(scan).subspan(cut);
            EXPECT_EQ(classify(115200, part).kind, HeardKind::scan_data)
                << "from byte " << cut << " of " << scan.size();
        }
    }
}

TEST(Heard, NoiseIsNeverTakenForAScan) {
    std::mt19937 random(1);
    for (int i = 0; i < 10'000; ++i) {
        const auto bytes = random_bytes(random, 50 + random() % 1000);
        ASSERT_EQ(classify(115200, bytes).kind, HeardKind::noise) << "case " << i;
    }
}

}  // namespace
}  // namespace sweepcast::diagnosis
