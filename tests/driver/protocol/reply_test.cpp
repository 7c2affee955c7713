// Replies of one packet: read, written, refused; the names and numbers that people see; what errors
// say.
#include "driver/protocol/reply.hpp"

#include "driver/protocol/decode.hpp"
#include "driver/protocol/error.hpp"
#include "driver/protocol/wire.hpp"

#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

namespace sweepcast::protocol {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::microseconds;

const Bytes info_packet{0x18, 0x1D, 0x01, 0x07, 0xA0, 0x01, 0x02, 0x03, 0x04, 0x05,
                        0x06, 0x07, 0x08, 0x09, 0x0A, 0x0B, 0x0C, 0x0D, 0x0E, 0x0F};

TEST(DeviceInfoTest, HasFirmwareMinorBeforeMajor) {
    const auto info = decode_device_info(info_packet).value();
    EXPECT_EQ(info.model, 0x18);
    EXPECT_EQ(info.firmware_major, 1);
    EXPECT_EQ(info.firmware_minor, 29);
    EXPECT_EQ(info.hardware, 7);
    EXPECT_EQ(info.serial[0], 0xA0);
    EXPECT_EQ(info.serial[15], 0x0F);
}

TEST(DeviceInfoTest, IsWrittenAsItIsRead) {
    const auto packet = encode_device_info(decode_device_info(info_packet).value());
    EXPECT_EQ(Bytes(packet.begin(), packet.end()), info_packet);
}

TEST(HealthTest, HasItsCodeLittleEndian) {
    EXPECT_EQ(decode_health(Bytes{2, 0x01, 0x80}).value(), (Health{HealthStatus::error, 0x8001}));
}

TEST(HealthTest, IsReadAsItIsWritten) {
    const Health health{HealthStatus::warning, 0x1234};
    EXPECT_EQ(decode_health(encode_health(health)).value(), health);
}

TEST(HealthTest, IsRefusedWithAnUnknownStatus) {
    EXPECT_EQ(decode_health(Bytes{3, 0, 0}).error(), errc::malformed_reply);
}

TEST(SampleRateTest, IsReadAsItIsWritten) {
    const SampleRate rate{microseconds{504}, microseconds{252}};
    EXPECT_EQ(decode_sample_rate(encode_sample_rate(rate)).value(), rate);
}

TEST(SampleRateTest, IsWrittenClampedToItsFields) {
    const auto packet = encode_sample_rate({microseconds{-1}, microseconds{70000}});
    EXPECT_EQ(
        decode_sample_rate(packet).value(),
        (SampleRate{microseconds{0}, microseconds{65535}})
    );
}

TEST(AccBoardFlagTest, IsItsLowestBit) {
    EXPECT_TRUE(decode_acc_board_flag(Bytes{1, 0, 0, 0}).value().controls_motor);
    EXPECT_FALSE(decode_acc_board_flag(Bytes{0xFE, 0xFF, 0xFF, 0xFF}).value().controls_motor);
    for (const AccessoryBoard board : {AccessoryBoard{true}, AccessoryBoard{false}}) {
        EXPECT_EQ(decode_acc_board_flag(encode_acc_board_flag(board)).value(), board);
    }
}

TEST(ReplyTest, IsRefusedWithAnyOtherLength) {
    for (std::size_t size = 0; size < 32; ++size) {
        const Bytes packet(size);
        EXPECT_EQ(decode_device_info(packet).has_value(), size == 20) << size;
        EXPECT_EQ(decode_health(packet).has_value(), size == 3) << size;
        EXPECT_EQ(decode_sample_rate(packet).has_value(), size == 4) << size;
        EXPECT_EQ(decode_acc_board_flag(packet).has_value(), size == 4) << size;
    }
    EXPECT_EQ(decode_health(Bytes{}).error(), errc::length_out_of_range);
}

TEST(SerialTextTest, IsHexInWireOrder) {
    const auto info = decode_device_info(info_packet).value();
    EXPECT_EQ(serial_text(info.serial), "A00102030405060708090A0B0C0D0E0F");
    EXPECT_EQ(short_serial_text(info.serial), "A0010203");
}

TEST(ProtocolErrorTest, EachSaysSomethingOfItsOwn) {
    std::set<std::string> messages;
    for (const auto code :
         {errc::checksum_mismatch,
          errc::length_out_of_range,
          errc::unsupported_answer_type,
          errc::malformed_reply,
          errc::conf_type_mismatch,
          errc::conf_not_supported,
          errc::conf_refused}) {
        messages.insert(make_error_code(code).message());
    }
    messages.insert(boost::system::error_code(99, protocol_category()).message());
    EXPECT_EQ(messages.size(), 8U);
    EXPECT_EQ(
        make_error_code(errc::malformed_reply).category().name(),
        std::string("sweepcast.protocol")
    );
}

TEST(DecoderTest, RefusesWhatIsNoMeasurementStream) {
    for (const int type : {0x00, 0x04, 0x80, 0x87, 0xFF}) {
        const auto decoder = Decoder::create(static_cast<AnswerType>(type), {});
        EXPECT_EQ(decoder.error(), errc::unsupported_answer_type) << type;
    }
}

TEST(WireTest, IntegersAreLittleEndian) {
    std::array<std::uint8_t, 4> bytes{0x78, 0x56, 0x34, 0xF2};
    EXPECT_EQ(load_le32(bytes), 0xF2345678U);
    EXPECT_EQ(load_le16(std::span(bytes).first<2>()), 0x5678);
    store_le32(bytes, 0x01020304);
    EXPECT_EQ(bytes, (std::array<std::uint8_t, 4>{4, 3, 2, 1}));
    store_le16(std::span(bytes).first<2>(), 0xABCD);
    EXPECT_EQ(bytes, (std::array<std::uint8_t, 4>{0xCD, 0xAB, 2, 1}));
}

TEST(WireTest, TheChecksumOfNothingIsZero) {
    EXPECT_EQ(xor_checksum({}), 0);
    EXPECT_EQ(xor_checksum(std::array<std::uint8_t, 3>{0xF0, 0x0F, 0x01}), 0xFE);
}

}  // namespace
}  // namespace sweepcast::protocol
