// The host side of the vendor's SDK, request by request and with its waits, played to the personas
// whose answers are known: each has to come whole, in order and soon, and where a real scanner is
// silent there has to be silence.
#include "driver/protocol/decode.hpp"
#include "tests/driver/virtual/fake_host.hpp"
#include "tests/driver/virtual/hex.hpp"
#include "tests/driver/virtual/vendor_dialogues.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;

struct Dialogue {
    const char* name;
    const char* persona;
    std::span<const Exchange> exchanges;
};
void PrintTo(const Dialogue& dialogue, std::ostream* out) {
    *out << dialogue.name;
}

class VendorDialogue : public testing::TestWithParam<Dialogue> {
protected:
    VendorDialogue() : host_(GetParam().persona) {}

    void play(const Exchange& exchange) {
        host_.run(std::chrono::milliseconds(exchange.wait_ms));
        if (scanning_) {
            expect_samples();
        } else {
            EXPECT_EQ(host_.received(), Bytes{}) << "before " << exchange.request;
        }
        host_.send(from_hex(exchange.request));
        const bool is_motor_command =
            exchange.request.starts_with("A5 F0") || exchange.request.starts_with("A5 A8");
        if (scanning_ && !is_motor_command) {
            scanning_ = false;
            host_.run(100ms);
            host_.received();  // what was on its way
        } else if (!exchange.answer.empty()) {
            expect_answer(exchange);
        }
    }

private:
    void expect_answer(const Exchange& exchange) {
        const auto expected =
            exchange.answer == boot_text
                ? Bytes(host_.persona.boot_text.begin(), host_.persona.boot_text.end())
                : from_hex(exchange.answer);
        Bytes answer;
        for (int i = 0; i < 500 && answer.size() < expected.size(); ++i) {
            host_.run(100us, 100us);
            const auto more = host_.received();
            answer.insert(answer.end(), more.begin(), more.end());
        }
        EXPECT_EQ(answer, expected) << "to " << exchange.request;
        constexpr std::uint8_t many = 0x40;
        if (expected.size() == 7 && (expected[5] & many) != 0) {
            scanning_ = true;
            type_ = protocol::AnswerType{expected[6]};
        }
    }

    // A scan of two seconds more, most of it after the motor has come up to speed.
    void expect_samples() {
        host_.run(2s);
        auto decoder = protocol::Decoder::create(type_, {.sample_duration = 100us});
        ASSERT_TRUE(decoder);
        protocol::Decoded decoded;
        decoder->push(host_.measurements(), {}, decoded);
        EXPECT_GT(decoded.samples.size(), 1000U);
        EXPECT_TRUE(std::ranges::any_of(decoded.samples, &protocol::Sample::starts_revolution));
    }

    FakeHost host_;
    bool scanning_{};
    protocol::AnswerType type_{};
};

TEST_P(VendorDialogue, IsAnsweredAsByARealScanner) {
    for (const auto& exchange : GetParam().exchanges) {
        play(exchange);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Personas,
    VendorDialogue,
    testing::Values(
        Dialogue{"a1m8", "a1m8", a1_dialogue},
        Dialogue{"a3m1", "a3m1", a3_dialogue},
        Dialogue{"s2", "s2", s2_dialogue},
        Dialogue{"c1", "c1", c1_dialogue},
        Dialogue{"old_firmware", "a2m8-old", old_dialogue},
        Dialogue{"autobaud", "c1", autobaud_c1_dialogue}
    ),
    [](const auto& test) { return std::string(test.param.name); }
);

// The SDK takes the value of these without looking whether there is one, and dies.
TEST(DesiredRotation, IsNeverEchoedWithoutAValue) {
    for (const auto& persona : personas()) {
        FakeHost host(persona.key);
        for (const auto& [type, size] : {std::pair{0x01, 4U}, {0x04, 2U}, {0x05, 2U}}) {
            host.send(
                protocol::Command::get_lidar_conf,
                {static_cast<std::uint8_t>(type), 0, 0, 0}
            );
            host.run(20ms);
            const auto answer = host.received();
            const bool silent = persona.key == "a2m8-old";
            EXPECT_EQ(answer.size(), silent ? 0 : 7U + 4U + size) << persona.key << " " << type;
        }
    }
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
