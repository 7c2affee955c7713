// What follows from a model number.
#include "driver/protocol/model.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace sweepcast::protocol {
namespace {

class ModelNameTest : public testing::TestWithParam<std::pair<int, const char*>> {};

TEST_P(ModelNameTest, IsFormedAsTheVendorDoes) {
    const auto [model, name] = GetParam();
    EXPECT_EQ(model_name(static_cast<std::uint8_t>(model)), name);
}

INSTANTIATE_TEST_SUITE_P(
    Known,
    ModelNameTest,
    testing::Values(
        std::pair{0x18, "A1M8"},
        std::pair{0x27, "A2M7"},
        std::pair{0x2C, "A2M12"},
        std::pair{0x31, "A3M1"},
        std::pair{0x41, "C1M1"},
        std::pair{0x51, "C2M1"},
        std::pair{0x61, "S1M1"},
        std::pair{0x71, "S2M1"},
        std::pair{0x81, "S3M1"},
        std::pair{0x91, "T1M1"},
        std::pair{0xB2, "T3M2"},
        std::pair{0xC0, "M1M0"},
        std::pair{0xFF, "M4M15"},
        std::pair{0x00, "A0M0"}
    )
);

DeviceInfo of(std::uint8_t model, std::uint8_t major, std::uint8_t minor) {
    return {
        .model = model,
        .firmware_major = major,
        .firmware_minor = minor,
        .hardware = 0,
        .serial = {}};
}

TEST(ModelTest, MotorsAreControlledByFamily) {
    EXPECT_EQ(motor_control_of(0x18), MotorControl::modem_line);
    EXPECT_EQ(motor_control_of(0x28), MotorControl::accessory_board);
    EXPECT_EQ(motor_control_of(0x31), MotorControl::accessory_board);
    EXPECT_EQ(motor_control_of(0x41), MotorControl::self);
    EXPECT_EQ(motor_control_of(0x61), MotorControl::rpm);
    EXPECT_EQ(motor_control_of(0x81), MotorControl::rpm);
    EXPECT_EQ(motor_control_of(0x91), MotorControl::rpm);
}

TEST(ModelTest, AModelsKnowTheirConfigurationFromFirmware124On) {
    EXPECT_FALSE(knows_lidar_conf(of(0x28, 1, 23)));
    EXPECT_TRUE(knows_lidar_conf(of(0x28, 1, 24)));
    EXPECT_TRUE(knows_lidar_conf(of(0x18, 2, 0)));
}

TEST(ModelTest, NewerFamiliesKnowItWithAnyFirmware) {
    EXPECT_TRUE(knows_lidar_conf(of(0x41, 1, 2)));
    EXPECT_TRUE(knows_express(of(0x81, 1, 2)));
    EXPECT_TRUE(knows_baud_negotiation(of(0x61, 1, 0)));
}

TEST(ModelTest, AModelsKnowExpressFromFirmware117AndNegotiationFrom130On) {
    EXPECT_FALSE(knows_express(of(0x18, 1, 16)));
    EXPECT_TRUE(knows_express(of(0x18, 1, 17)));
    EXPECT_FALSE(knows_baud_negotiation(of(0x18, 1, 29)));
    EXPECT_TRUE(knows_baud_negotiation(of(0x18, 1, 30)));
}

}  // namespace
}  // namespace sweepcast::protocol
