// JSON of the schema's messages.
#include "server/api/json.hpp"

#include "sweepcast/v1/api.pb.h"
#include "sweepcast/v1/scan.pb.h"

#include <boost/json/parse.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

namespace sweepcast::api {
namespace {

namespace json = boost::json;
using testing::HasSubstr;

constexpr std::uint64_t largest_exact = std::uint64_t{1} << 53;

TEST(ToJson, FieldsHaveTheNamesOfTheSchema) {
    v1::Diagnosis message;
    message.add_next_steps("plug it in");
    EXPECT_THAT(to_json(message), HasSubstr("\"next_steps\""));
    EXPECT_THAT(to_json(message), HasSubstr("\"likely_causes\""));
    EXPECT_THAT(to_json_line(message), HasSubstr("\"next_steps\":[\"plug it in\"]"));
}

TEST(ToJson, CountsAreNumbers) {
    v1::ListLidarsResponse message;
    message.add_lidars()->set_state_changes(3);
    message.mutable_lidars(0)->mutable_line()->set_bytes(largest_exact);
    message.add_lidars()->mutable_line()->set_bytes(5);
    message.mutable_lidars(1)->set_state_changes(4);
    for (const auto& text : {to_json(message), to_json_line(message)}) {
        const auto lidars = json::parse(text).at("lidars");
        EXPECT_EQ(lidars.at(0).at("state_changes"), 3);
        EXPECT_EQ(lidars.at(0).at("line").at("bytes"), static_cast<std::int64_t>(largest_exact));
        EXPECT_EQ(lidars.at(0).at("line").at("samples"), 0);
        EXPECT_EQ(lidars.at(1).at("line").at("bytes"), 5);
        EXPECT_EQ(lidars.at(1).at("state_changes"), 4);
    }
}

TEST(ToJson, ListsOfCountsAreNumbersToo) {
    v1::Scan message;
    message.add_time_step_ps(-7);
    message.add_time_step_ps(std::numeric_limits<std::int64_t>::min());
    message.add_time_step_ps(8);
    const auto steps = json::parse(to_json(message)).at("time_step_ps");
    EXPECT_EQ(steps, json::parse(R"([-7, "-9223372036854775808", 8])"));
}

TEST(ToJson, ACountThatADoubleCannotHoldStaysText) {
    v1::Line message;
    message.set_bytes(largest_exact + 1);
    message.set_samples(std::numeric_limits<std::uint64_t>::max());
    const auto line = json::parse(to_json(message));
    EXPECT_EQ(line.at("bytes"), "9007199254740993");
    EXPECT_EQ(line.at("samples"), "18446744073709551615");
}

TEST(ToJson, TextThatLooksLikeACountStaysText) {
    v1::Lidar message;
    message.set_id("12345678");
    message.set_cause(R"(\"bytes\": "5", {\)");
    message.set_hint("7");
    message.mutable_line()->set_bytes(5);
    const auto lidar = json::parse(to_json(message));
    EXPECT_EQ(lidar.at("id"), "12345678");
    EXPECT_EQ(lidar.at("cause").as_string(), message.cause());
    EXPECT_EQ(lidar.at("hint"), "7");
    EXPECT_EQ(lidar.at("line").at("bytes"), 5);
}

TEST(ToJson, PointsInTimeAreRfc3339) {
    v1::Lidar message;
    message.mutable_since()->set_seconds(1'700'000'000);
    message.mutable_since()->set_nanos(123'456'789);
    EXPECT_EQ(json::parse(to_json(message)).at("since"), "2023-11-14T22:13:20.123456789Z");
}

TEST(ToJson, IsReadBackAsTheSameMessage) {
    v1::LatestScan scan;
    scan.set_sequence(largest_exact + 1);
    scan.set_rotation_hz(9.75);
    scan.add_time_us(-3);
    scan.mutable_time()->set_seconds(1'700'000'000);
    v1::LatestScan read;
    ASSERT_TRUE(from_json(to_json(scan), read));
    EXPECT_EQ(read.SerializeAsString(), scan.SerializeAsString());
}

TEST(FromJson, TakesTheNamesOfTheSchemaAndLowerCamelCase) {
    for (const auto* text : {R"({"speed_hz": 7.5})", R"({"speedHz": 7.5})"}) {
        v1::UpdateRequest message;
        ASSERT_TRUE(from_json(text, message)) << text;
        EXPECT_EQ(message.speed_hz(), 7.5);
    }
}

TEST(FromJson, AModeMayBeANumber) {
    v1::UpdateRequest message;
    ASSERT_TRUE(from_json(R"({"mode": 0, "speed_hz": 7.5})", message));
    EXPECT_EQ(message.mode(), "0");
    EXPECT_EQ(message.speed_hz(), 7.5);
    v1::StartRequest start;
    ASSERT_TRUE(from_json(R"({"mode": 12})", start));
    EXPECT_EQ(start.mode(), "12");
}

TEST(FromJson, RefusesWhatIsNeitherTextNorAWholeNumber) {
    for (const auto* text :
         {R"({"mode": 0.5})", R"({"mode": true})", R"({"mode": [0]})", R"({"mode": {}})"}) {
        v1::StartRequest message;
        EXPECT_FALSE(from_json(text, message)) << text;
    }
}

}  // namespace
}  // namespace sweepcast::api
