// identify(): what a lidar is asked, and what is made of answers that do not come.
#include "driver/device/identify.hpp"

#include "driver/device/error.hpp"
#include "tests/driver/device/fake_scanner.hpp"
#include "tests/driver/device/memory_link.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

namespace sweepcast::device {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using protocol::Command;
using protocol::ConfType;

class IdentifyTest : public testing::Test {
protected:
    Result<Identity> ask() {
        MemoryLink link(line);
        Conversation talk(link);
        auto answer = asio::co_spawn(context, identify(talk), asio::use_future);
        context.run();
        context.restart();
        return answer.get();
    }

    asio::io_context context;
    Line line{context.get_executor()};
    FakeScanner scanner{line};
};

TEST_F(IdentifyTest, ListsTheModesWithIdsRangesAndTheTypicalOne) {
    scanner.list_modes();
    const auto identity = ask();
    ASSERT_TRUE(identity);
    ASSERT_EQ(identity->modes.size(), 3U);
    const auto& dense = identity->modes[1];
    EXPECT_EQ(dense.name, "DenseBoost");
    EXPECT_EQ(dense.id, 1);
    EXPECT_EQ(dense.answer_type, protocol::AnswerType::dense);
    EXPECT_EQ(dense.sample_duration, 31250ns);
    EXPECT_EQ(dense.samples_per_second(), 32000);
    EXPECT_EQ(dense.max_distance_mm, 40000);
    EXPECT_FALSE(dense.typical);
    EXPECT_TRUE(identity->modes[2].typical);
}

TEST_F(IdentifyTest, TakesTheSpeedsThatTheLidarIsMadeFor) {
    scanner.list_modes();
    scanner.conf[{ConfType::desired_rotation, 0}] = {0x2C, 0x01, 0x40, 0x01};
    const auto identity = ask();
    ASSERT_TRUE(identity);
    EXPECT_EQ(identity->motor.desired, (protocol::DesiredRotation{300, 320}));
    EXPECT_EQ(identity->motor.min_rpm, 300);
    EXPECT_EQ(identity->motor.max_rpm, 900);
}

TEST_F(IdentifyTest, DoesNotBelieveSpeedsThatWouldStopTheMotor) {
    scanner.list_modes();
    scanner.conf[{ConfType::desired_rotation, 0}] = {0, 0, 0, 0};
    scanner.conf[{ConfType::max_rotation, 0}] = {0, 0};
    const auto identity = ask();
    ASSERT_TRUE(identity);
    EXPECT_EQ(identity->motor.desired, (protocol::DesiredRotation{600, 660}));
    EXPECT_EQ(identity->motor.max_rpm, 0);
}

TEST_F(IdentifyTest, CallsALidarByItsAlias) {
    scanner.list_modes();
    scanner.conf[{ConfType::model_alias, 0}] = {'A', '3', 'M', '1', '-', 'R', '1', 0};
    const auto identity = ask();
    ASSERT_TRUE(identity);
    EXPECT_EQ(shown_name(*identity), "A3M1-R1");
}

TEST_F(IdentifyTest, ALidarThatEchoesBarelyHasTheLegacyModes) {
    const auto identity = ask();
    ASSERT_TRUE(identity);
    ASSERT_EQ(identity->modes.size(), 2U);
    EXPECT_FALSE(identity->modes[1].id);
    EXPECT_EQ(identity->modes[1].sample_duration, 250us);
    EXPECT_EQ(scanner.count(Command::get_lidar_conf), 1U);
}

TEST_F(IdentifyTest, ALidarSilentAboutItsConfigurationHasTheLegacyModes) {
    scanner.knows_conf = false;
    const auto identity = ask();
    ASSERT_TRUE(identity);
    EXPECT_EQ(identity->modes.size(), 2U);
}

TEST_F(IdentifyTest, OldFirmwareIsNotAskedForItsConfiguration) {
    scanner.info.firmware_minor = 20;
    scanner.knows_conf = false;
    const auto identity = ask();
    ASSERT_TRUE(identity);
    EXPECT_EQ(identity->modes.size(), 2U);
    EXPECT_EQ(scanner.count(Command::get_lidar_conf), 0U);
}

TEST_F(IdentifyTest, FirmwareOlderStillIsKnownToTake476Microseconds) {
    scanner.info.firmware_minor = 15;
    const auto identity = ask();
    ASSERT_TRUE(identity);
    ASSERT_EQ(identity->modes.size(), 1U);
    EXPECT_EQ(identity->modes[0].sample_duration, 476us);
    EXPECT_EQ(scanner.count(Command::get_sample_rate), 0U);
}

TEST_F(IdentifyTest, ALidarSilentAboutItsSampleRateGetsTheDocumentedOne) {
    scanner.info.firmware_minor = 20;
    scanner.knows_sample_rate = false;
    const auto identity = ask();
    ASSERT_TRUE(identity);
    EXPECT_EQ(identity->modes[0].sample_duration, 476us);
}

TEST_F(IdentifyTest, AModeThatCannotBeDecodedIsNotListed) {
    scanner.list_modes();
    scanner.conf[{ConfType::mode_answer_type, 1}] = {0x99};
    const auto identity = ask();
    ASSERT_TRUE(identity);
    ASSERT_EQ(identity->modes.size(), 2U);
    EXPECT_EQ(identity->modes[1].id, 2);
}

TEST_F(IdentifyTest, AModeWithoutANameGoesByItsId) {
    scanner.list_modes();
    scanner.conf.erase({ConfType::mode_name, 1});
    scanner.conf[{ConfType::mode_name, 2}] = {0};
    const auto identity = ask();
    ASSERT_TRUE(identity);
    EXPECT_EQ(identity->modes[1].name, "Mode 1");
    EXPECT_EQ(identity->modes[2].name, "Mode 2");
}

TEST_F(IdentifyTest, AnAbsurdNumberOfModesIsNotAskedFor) {
    scanner.list_modes();
    scanner.conf[{ConfType::scan_mode_count, 0}] = {0xFF, 0xFF};
    const auto identity = ask();
    ASSERT_TRUE(identity);
    EXPECT_EQ(identity->modes.size(), 3U);
    EXPECT_LE(scanner.count(Command::get_lidar_conf), 200U);
}

struct MotorCase {
    std::uint8_t model;
    std::optional<protocol::AccessoryBoard> board;
    protocol::MotorControl control;
};

class MotorOfModel : public IdentifyTest, public testing::WithParamInterface<MotorCase> {};

TEST_P(MotorOfModel, IsControlledAsItsFamilyAndBoardSay) {
    scanner.info.model = GetParam().model;
    scanner.board = GetParam().board;
    const auto identity = ask();
    ASSERT_TRUE(identity);
    EXPECT_EQ(identity->motor.control, GetParam().control);
}

INSTANTIATE_TEST_SUITE_P(
    Families,
    MotorOfModel,
    testing::Values(
        MotorCase{0x18, std::nullopt, protocol::MotorControl::modem_line},
        MotorCase{0x28, protocol::AccessoryBoard{true}, protocol::MotorControl::accessory_board},
        MotorCase{0x28, protocol::AccessoryBoard{false}, protocol::MotorControl::modem_line},
        MotorCase{0x31, std::nullopt, protocol::MotorControl::modem_line},
        MotorCase{0x41, std::nullopt, protocol::MotorControl::self},
        MotorCase{0x71, std::nullopt, protocol::MotorControl::rpm}
    )
);

}  // namespace
}  // namespace sweepcast::device
