// Autobaud: measuring the host's speed, the trial, and what ends it.
#include "driver/virtual/autobaud.hpp"

#include "driver/protocol/request.hpp"
#include "tests/driver/virtual/fake_host.hpp"

#include <gtest/gtest.h>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;

constexpr Moment start{};
const Bytes block(16, protocol::autobaud_byte);

Bytes confirmation(std::uint32_t baud) {
    return protocol::confirm_baud_request(baud).payload;
}

Autobaud on_trial() {
    Autobaud autobaud(460'800);
    (void)autobaud.push(block, 115'200, start);
    EXPECT_EQ(autobaud.push(block, 115'200, start + 2ms), 115'200U);
    return autobaud;
}

TEST(Autobaud, MeasuresAHostThatKeepsSendingTheMagicByte) {
    Autobaud autobaud(460'800);
    EXPECT_EQ(autobaud.push(block, 115'200, start), std::nullopt) << "one block is not enough";
    EXPECT_EQ(autobaud.baud(), 460'800U);
    EXPECT_EQ(autobaud.push(block, 115'200, start + 2ms), 115'200U);
    EXPECT_EQ(autobaud.baud(), 115'200U);
    EXPECT_EQ(autobaud.push(block, 115'200, start + 4ms), std::nullopt) << "it has been said";
    EXPECT_EQ(autobaud.push(block, 115'200, start + 6ms), std::nullopt);
}

TEST(Autobaud, MeasuresNothingElse) {
    Autobaud autobaud(460'800);
    EXPECT_EQ(autobaud.push(Bytes(100, 0x42), 115'200, start), std::nullopt);
    EXPECT_EQ(autobaud.push(block, 115'200, start), std::nullopt);
    EXPECT_EQ(autobaud.push(Bytes{0xA5, 0x50}, 115'200, start), std::nullopt);
    EXPECT_EQ(autobaud.push(block, 115'200, start), std::nullopt) << "the run was broken";
    EXPECT_EQ(autobaud.push(block, 115'200, start + 1s), std::nullopt) << "it was too slow";
    EXPECT_EQ(autobaud.push(block, 3'000'000, start + 1s), std::nullopt) << "it is too fast";
}

TEST(Autobaud, KeepsTheSpeedThatIsConfirmed) {
    auto autobaud = on_trial();
    autobaud.confirm(confirmation(115'200));
    EXPECT_EQ(autobaud.trial_ends(), std::nullopt);
    autobaud.advance(start + 1h);
    EXPECT_EQ(autobaud.baud(), 115'200U);
    autobaud.reset();
    EXPECT_EQ(autobaud.baud(), 460'800U);
}

TEST(Autobaud, FallsBackIfNobodyConfirms) {
    auto autobaud = on_trial();
    ASSERT_TRUE(autobaud.trial_ends());
    autobaud.advance(*autobaud.trial_ends() - 1ns);
    EXPECT_EQ(autobaud.baud(), 115'200U);
    autobaud.advance(*autobaud.trial_ends());
    EXPECT_EQ(autobaud.baud(), 460'800U);
}

TEST(Autobaud, TakesNoOtherConfirmation) {
    for (auto payload : {confirmation(256'000), Bytes{}, Bytes(8, 0x00)}) {
        auto autobaud = on_trial();
        autobaud.confirm(payload);
        EXPECT_TRUE(autobaud.trial_ends());
    }
    Autobaud without_trial(460'800);
    without_trial.confirm(confirmation(115'200));
    EXPECT_EQ(without_trial.baud(), 460'800U);
}

TEST(Autobaud, IsNotKnownToOldFirmware) {
    FakeHost a1("a1m8");
    a1.send(Bytes(64, protocol::autobaud_byte));
    a1.run(100ms);
    EXPECT_TRUE(a1.received().empty());
}

TEST(Autobaud, AnswersWithTheBareSpeed) {
    FakeHost c1("c1");
    c1.send(Bytes(64, protocol::autobaud_byte));
    c1.run(100ms);
    EXPECT_EQ(c1.received(), (Bytes{0x00, 0x08, 0x07, 0x00}));
    c1.send(protocol::encode(protocol::confirm_baud_request(460'800)));
    c1.send(protocol::Command::get_health);
    c1.run(10ms);
    EXPECT_EQ(c1.received().size(), 10U);
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
