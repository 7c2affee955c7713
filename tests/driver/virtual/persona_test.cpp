// Personas: each is complete and consistent, and serial numbers are what they should be.
#include "driver/virtual/persona.hpp"

#include "driver/virtual/measurement_stream.hpp"

#include <gtest/gtest.h>

namespace sweepcast::virtual_lidar {
namespace {

TEST(Persona, IsFoundByItsKey) {
    ASSERT_NE(find_persona("a1m8"), nullptr);
    EXPECT_EQ(find_persona("a1m8")->model, 0x18);
    EXPECT_EQ(find_persona("A1M8"), nullptr);
    EXPECT_EQ(find_persona(""), nullptr);
}

TEST(Persona, PlaysOnlyModesThatFitOnItsLine) {
    for (const auto& persona : personas()) {
        ASSERT_FALSE(persona.modes.empty()) << persona.key;
        EXPECT_LT(persona.typical_mode, persona.modes.size()) << persona.key;
        EXPECT_EQ(persona.modes.front().answer, protocol::AnswerType::normal) << persona.key;
        for (const auto& mode : persona.modes) {
            ASSERT_TRUE(can_stream(mode.answer)) << persona.key << ' ' << mode.name;
            const bool normal = mode.answer == protocol::AnswerType::normal;
            const double samples = normal ? 1.0 : 32.0;
            const double packet_s =
                samples * std::chrono::duration<double>(mode.sample_duration()).count();
            const auto bytes = static_cast<double>(protocol::packet_size(mode.answer));
            EXPECT_LT(bytes / packet_s, persona.baud / 10.0) << persona.key << ' ' << mode.name;
        }
    }
}

TEST(Persona, SaysInItsBootTextWhatItSaysInItsDeviceInfo) {
    const auto& a1 = *find_persona("a1m8");
    EXPECT_EQ(a1.boot_text.size(), 64U);
    EXPECT_NE(a1.boot_text.find("Ver 1.29"), std::string_view::npos);
    EXPECT_NE(a1.boot_text.find("HW Ver 7"), std::string_view::npos);
    EXPECT_NE(a1.boot_text.find("Model: 18"), std::string_view::npos);
    EXPECT_EQ(a1.boot_text.find('\xA5'), std::string_view::npos);
}

TEST(SerialNumber, DependsOnTheSeedAlone) {
    EXPECT_EQ(serial_from("one"), serial_from("one"));
    EXPECT_NE(serial_from("one"), serial_from("two"));
    EXPECT_NE(serial_from(""), SerialNumber{});
}

TEST(SerialNumber, IsReadFromHexDigitsInWireOrder) {
    const SerialNumber expected{0xA0, 0xE1, 0xC2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x0F};
    EXPECT_EQ(parse_serial("A0e1C20000000000000000000000000F"), expected);
}

TEST(SerialNumber, IsNotReadFromAnythingElse) {
    EXPECT_FALSE(parse_serial(""));
    EXPECT_FALSE(parse_serial("A0E1"));
    EXPECT_FALSE(parse_serial("A0E1C20000000000000000000000000F0"));
    EXPECT_FALSE(parse_serial("G0E1C20000000000000000000000000F"));
    EXPECT_FALSE(parse_serial("A0E1C2000000000000000000000000 F"));
    EXPECT_FALSE(parse_serial("-1E1C20000000000000000000000000F"));
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
