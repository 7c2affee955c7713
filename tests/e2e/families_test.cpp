// Every family of lidars through the real program: found, named, scanning in its own mode, turning
// as fast as its user wants.
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <vector>

namespace sweepcast::test {
namespace {

using protocol::AnswerType;
using testing::ElementsAreArray;
using testing::HasSubstr;

struct Family {
    std::string key;
    std::string model;  ///< as the gateway tells it
    std::uint32_t baud{};
    std::vector<std::string> modes;
    std::string typical;
    AnswerType answer{};
};

void PrintTo(const Family& family, std::ostream* out) {
    *out << family.key;
}

const Family families[] = {
    {"a1m8", "A1M8", 115'200, {"Standard", "Express", "Boost"}, "Express", AnswerType::express},
    {"a2m8",
     "A2M8",
     115'200,
     {"Standard", "Express", "Boost", "Sensitivity"},
     "Sensitivity",
     AnswerType::ultra},
    {"a2m8-old", "A2M8", 115'200, {"Standard", "Express"}, "Express", AnswerType::express},
    {"a2m12",
     "A2M12",
     256'000,
     {"Standard", "Express", "Boost", "Sensitivity"},
     "Sensitivity",
     AnswerType::ultra},
    {"a3m1",
     "A3M1",
     256'000,
     {"Standard", "Express", "Boost", "Sensitivity", "Stability"},
     "Sensitivity",
     AnswerType::ultra},
    {"s1", "S1M1", 256'000, {"Standard", "DenseBoost"}, "DenseBoost", AnswerType::dense},
    {"s2", "S2M1-R2L", 1'000'000, {"Standard", "DenseBoost"}, "DenseBoost", AnswerType::dense},
    {"s3", "S3M1", 1'000'000, {"Standard", "DenseBoost", "HQ"}, "DenseBoost", AnswerType::dense},
    {"c1", "C1M1-R2", 460'800, {"Standard", "UltraDense"}, "UltraDense", AnswerType::ultra_dense},
};

std::vector<std::string> names_of(const v1::Lidar& lidar) {
    std::vector<std::string> names;
    for (const auto& mode : lidar.modes()) {
        names.push_back(mode.name());
    }
    return names;
}

class FamilyTest : public testing::TestWithParam<Family> {};

TEST_P(FamilyTest, IsIdentifiedWithoutBeingToldAndScansInItsTypicalMode) {
    const auto& family = GetParam();
    const std::string serial(32, 'A');
    const VirtualLidarProcess played({"--model", family.key, "--serial", serial});
    const GatewayProcess gateway({"--lidar", played.port});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    const auto lidar = client.wait_for_state(v1::Lidar::SCANNING);
    EXPECT_EQ(lidar.id(), serial.substr(0, 8));
    EXPECT_EQ(lidar.device().model(), family.model);
    EXPECT_EQ(lidar.device().serial_number(), serial);
    EXPECT_EQ(lidar.line().baud(), family.baud);
    EXPECT_THAT(names_of(lidar), ElementsAreArray(family.modes));
    EXPECT_EQ(lidar.mode(), family.typical);
    client.next_sweep();  // what came first may have begun before the motor was at speed
    const auto sweep = client.next_sweep();
    EXPECT_EQ(sweep.scan.mode, family.typical);
    EXPECT_EQ(sweep.scan.answer_type, family.answer);
    EXPECT_GT(sweep.scan.sweep.samples.size(), 200);
}

INSTANTIATE_TEST_SUITE_P(
    OnASerialPort,
    FamilyTest,
    testing::ValuesIn(families),
    [](const auto& param) {
        auto name = param.param.key;
        std::erase(name, '-');
        return name;
    }
);

struct NetworkLidar {
    std::string key;
    std::string listen;
    std::string model;
};

class NetworkLidarTest : public testing::TestWithParam<NetworkLidar> {};

TEST_P(NetworkLidarTest, IsIdentifiedAndScans) {
    const VirtualLidarProcess played({"--model", GetParam().key, "--listen", GetParam().listen});
    const GatewayProcess gateway({"--lidar", played.port});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    const auto lidar = client.wait_for_state(v1::Lidar::SCANNING);
    EXPECT_EQ(lidar.device().model(), GetParam().model);
    EXPECT_EQ(lidar.url(), played.port);
    EXPECT_EQ(client.next_sweep().scan.answer_type, AnswerType::dense);
}

INSTANTIATE_TEST_SUITE_P(
    OfEachTransport,
    NetworkLidarTest,
    testing::Values(
        NetworkLidar{"t1", "udp://127.0.0.1:0", "T1M1"},
        NetworkLidar{"s1", "tcp://127.0.0.1:0", "S1M1"}
    ),
    [](const auto& param) { return param.param.key; }
);

/// Three lidars of different families on ptys of one directory.
struct ThreeLidars {
    ScratchDirectory scratch;
    VirtualLidarProcess a1{{"--model", "a1m8", "--link", scratch.file("lidar-a1")}};
    VirtualLidarProcess a3{{"--model", "a3m1", "--link", scratch.file("lidar-a3")}};
    VirtualLidarProcess s2{{"--model", "s2", "--link", scratch.file("lidar-s2")}};
};

/// Model and typical mode of all lidars that a gateway streams, once there are three.
std::map<std::string, std::string> models_and_modes(const GatewayProcess& gateway) {
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    std::map<std::string, v1::Lidar> scanning;
    std::set<std::string> streaming;
    while (scanning.size() < 3 || streaming.size() < 3) {
        const auto message = client.next();
        for (const auto& lidar : lidars_in(message)) {
            if (lidar.state() == v1::Lidar::SCANNING) {
                scanning[lidar.id()] = lidar;
            }
        }
        if (message.has_frame()) {
            streaming.insert(message.frame().lidar());
        }
    }
    std::map<std::string, std::string> found;
    for (const auto& [id, lidar] : scanning) {
        EXPECT_TRUE(streaming.contains(id));
        EXPECT_EQ(id, lidar.device().serial_number().substr(0, 8));
        found[lidar.device().model()] = lidar.mode();
    }
    return found;
}

const std::map<std::string, std::string> three_families{
    {"A1M8", "Express"},
    {"A3M1", "Sensitivity"},
    {"S2M1-R2L", "DenseBoost"}};

TEST(Families, OfThreeNamedLidarsEachStreamsInItsTypicalMode) {
    const ThreeLidars three;
    const GatewayProcess gateway(
        {"--lidar", three.a1.port, "--lidar", three.a3.port, "--lidar", three.s2.port}
    );
    EXPECT_EQ(models_and_modes(gateway), three_families);
}

TEST(Families, OfThreeFoundLidarsEachStreamsInItsTypicalMode) {
    const ThreeLidars three;
    const GatewayProcess gateway({"--discover", three.scratch.file("lidar-*")});
    EXPECT_EQ(models_and_modes(gateway), three_families);
}

TEST(Families, TwoNamedAndTheThirdFoundStreamInTheirTypicalModes) {
    const ThreeLidars three;
    const GatewayProcess gateway(
        {"--lidar",
         three.a1.port,
         "--lidar",
         three.a3.port,
         "--discover",
         three.scratch.file("lidar-*")}
    );
    EXPECT_EQ(models_and_modes(gateway), three_families);
}

class SpeedTest : public testing::TestWithParam<std::string> {};

TEST_P(SpeedTest, SevenTurnsASecondAreReachedAndSaidSo) {
    const VirtualLidarProcess played({"--model", GetParam()});
    const GatewayProcess gateway({"--lidar", played.port});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    const auto id = client.wait_for_state(v1::Lidar::SCANNING).id();
    const auto answer = http(gateway.http, "PATCH", "/api/v1/lidars/" + id, R"({"speed_hz": 7})");
    EXPECT_EQ(answer.status, 200) << answer.body;
    const auto settled = client.next([](const v1::ServerMessage& message) {
        return message.has_lidar() && message.lidar().rotation().wanted_hz() == 7.0 &&
               message.lidar().rotation().settled();
    });
    const auto& rotation = settled.lidar().rotation();
    EXPECT_NEAR(rotation.measured_hz(), 7.0, 0.02 * 7.0);
    EXPECT_EQ(rotation.warning(), "");
    // Not only says so: the revolutions themselves take a seventh of a second.
    const auto before = client.next_sweep();
    auto after = client.next_sweep();
    while (after.sequence < before.sequence + 7) {
        after = client.next_sweep();
    }
    const auto time =
        after.scan.sweep.samples.front().time - before.scan.sweep.samples.front().time;
    const auto turns = static_cast<double>(after.sequence - before.sequence);
    EXPECT_NEAR(turns / std::chrono::duration<double>(time).count(), 7.0, 0.03 * 7.0);
}

INSTANTIATE_TEST_SUITE_P(
    ByEveryWayOfDrivingAMotor,
    SpeedTest,
    testing::Values("a2m8", "a3m1", "s1"),
    [](const auto& param) { return param.param; }
);

TEST(Families, AC1RefusesAnotherSpeedAndSaysWhy) {
    const VirtualLidarProcess played({"--model", "c1"});
    const GatewayProcess gateway({"--lidar", played.port});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    const auto lidar = client.wait_for_state(v1::Lidar::SCANNING);
    EXPECT_EQ(lidar.rotation().control(), v1::Rotation::FIXED);
    const auto answer =
        http(gateway.http, "PATCH", "/api/v1/lidars/" + lidar.id(), R"({"speed_hz": 7})");
    EXPECT_EQ(answer.status, 409);
    EXPECT_THAT(answer.body, HasSubstr("fixed_speed"));
    client.next_sweep();
}

TEST(Families, AC1ToldInItsUrlToTurnAtAnotherSpeedScansAndWarns) {
    const VirtualLidarProcess played({"--model", "c1"});
    const GatewayProcess gateway({"--lidar", played.port + "?hz=7"});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    client.wait_for_lidar([](const v1::Lidar& lidar) {
        return lidar.state() == v1::Lidar::SCANNING && !lidar.rotation().warning().empty();
    });
    client.next_sweep();
}

TEST(Families, AModeIsChosenByItsId) {
    const VirtualLidarProcess played({"--model", "s3"});
    const GatewayProcess gateway({"--lidar", played.port});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    const auto id = client.wait_for_state(v1::Lidar::SCANNING).id();
    const auto answer = http(gateway.http, "PATCH", "/api/v1/lidars/" + id, R"({"mode": "2"})");
    EXPECT_EQ(answer.status, 200) << answer.body;
    EXPECT_THAT(answer.body, HasSubstr("\"HQ\""));
    auto sweep = client.next_sweep();
    while (sweep.scan.mode != "HQ") {
        sweep = client.next_sweep();
    }
    EXPECT_EQ(sweep.scan.answer_type, AnswerType::hq);
}

TEST(Families, ALidarIsCalledAsItsUserWants) {
    const VirtualLidarProcess played({"--model", "a1m8"});
    const GatewayProcess gateway({"--lidar", played.port + "?name=front&mode=Standard"});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe("front");
    const auto lidar = client.wait_for_state(v1::Lidar::SCANNING);
    EXPECT_EQ(lidar.id(), "front");
    EXPECT_EQ(lidar.mode(), "Standard");
    EXPECT_EQ(client.next_sweep().lidar, "front");
    EXPECT_EQ(http(gateway.http, "GET", "/api/v1/lidars/front").status, 200);
}

TEST(Families, TheLineSpeedOfALidarIsRememberedFromRunToRun) {
    const ScratchDirectory scratch;
    const VirtualLidarProcess played({"--model", "s2", "--link", scratch.file("lidar")});
    const std::vector<std::string> options{
        "--lidar",
        scratch.file("lidar"),
        "--state-dir",
        scratch.file("state"),
        "--log-level",
        "debug"};
    {
        GatewayProcess first(options);
        Subscriber client("tcp://" + first.tcp);
        client.subscribe();
        client.wait_for_state(v1::Lidar::SCANNING);
        first.process.signal(SIGTERM);
        EXPECT_EQ(first.process.wait(), 0);
        EXPECT_THAT(first.process.rest_of_log(), HasSubstr("looking for it at 115200, 256000"));
    }
    GatewayProcess second(options);
    Subscriber client("tcp://" + second.tcp);
    client.subscribe();
    client.wait_for_state(v1::Lidar::SCANNING);
    second.process.signal(SIGTERM);
    EXPECT_EQ(second.process.wait(), 0);
    EXPECT_THAT(second.process.rest_of_log(), HasSubstr("looking for it at 1000000, 115200"));
}

}  // namespace
}  // namespace sweepcast::test
