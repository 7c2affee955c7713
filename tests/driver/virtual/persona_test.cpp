// Personas: each is complete and consistent, and serial numbers are what they should be.
#include "driver/virtual/persona.hpp"

#include "driver/virtual/packer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

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
            const auto samples = static_cast<double>(make_packer(mode.answer)->samples());
            const double packet_s =
                samples * std::chrono::duration<double>(mode.sample_duration()).count();
            const auto bytes = static_cast<double>(protocol::packet_size(mode.answer));
            EXPECT_LT(bytes / packet_s, persona.baud / 10.0) << persona.key << ' ' << mode.name;
        }
    }
}

TEST(Persona, SaysInItsBootTextWhatItSaysInItsDeviceInfo) {
    int with_text = 0;
    for (const auto& persona : personas()) {
        const auto text = persona.boot_text;
        if (text.empty()) {
            continue;
        }
        ++with_text;
        EXPECT_EQ(text.size(), 64U) << persona.key;
        const auto version = "Ver " + std::to_string(persona.firmware_major) + "." +
                             std::to_string(persona.firmware_minor);
        EXPECT_NE(text.find(version), std::string_view::npos) << persona.key;
        const auto hardware = "HW Ver " + std::to_string(persona.hardware);
        EXPECT_NE(text.find(hardware), std::string_view::npos) << persona.key;
        constexpr std::string_view digits = "0123456789ABCDEF";
        const auto model = std::string("Model: ") + digits[persona.model >> 4] +
                           digits[persona.model & 15] + "\r\n";
        EXPECT_TRUE(text.ends_with(model)) << persona.key;
        EXPECT_EQ(text.find('\xA5'), std::string_view::npos) << persona.key;
    }
    EXPECT_EQ(with_text, 5) << "the A series";
}

struct Known {
    const char* key;
    const char* name;  ///< as the vendor forms it from the model number
    std::uint32_t baud;
    const char* typical;
};

TEST(Persona, IsOneOfTheModelsKnown) {
    const std::vector<Known> all{
        {"a1m8", "A1M8", 115'200, "Express"},
        {"a2m8", "A2M8", 115'200, "Sensitivity"},
        {"a2m8-old", "A2M8", 115'200, "Express"},
        {"a2m12", "A2M12", 256'000, "Sensitivity"},
        {"a3m1", "A3M1", 256'000, "Sensitivity"},
        {"s1", "S1M1", 256'000, "DenseBoost"},
        {"s2", "S2M1", 1'000'000, "DenseBoost"},
        {"s3", "S3M1", 1'000'000, "DenseBoost"},
        {"c1", "C1M1", 460'800, "UltraDense"},
        {"t1", "T1M1", 1'000'000, "Sensitivity"}};
    EXPECT_EQ(personas().size(), all.size());
    for (const auto& known : all) {
        const auto* const persona = find_persona(known.key);
        ASSERT_NE(persona, nullptr) << known.key;
        EXPECT_EQ(protocol::model_name(persona->model), known.name);
        EXPECT_EQ(persona->baud, known.baud) << known.key;
        EXPECT_EQ(persona->modes[persona->typical_mode].name, known.typical) << known.key;
        EXPECT_EQ(persona->motor.control, protocol::motor_control_of(persona->model)) << known.key;
    }
}

TEST(Persona, StreamsEveryAnswerTypeOnOneOrAnother) {
    using protocol::AnswerType;
    for (const auto type :
         {AnswerType::normal,
          AnswerType::express,
          AnswerType::hq,
          AnswerType::ultra,
          AnswerType::dense,
          AnswerType::ultra_dense}) {
        EXPECT_TRUE(std::ranges::any_of(personas(), [type](const Persona& persona) {
            return find_mode(persona, type) != nullptr;
        })) << static_cast<int>(type);
    }
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
