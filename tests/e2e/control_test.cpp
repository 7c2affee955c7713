// Control over HTTP, seen on the stream and by the lidar.
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>

namespace sweepcast::test {
namespace {

using testing::HasSubstr;

class ControlTest : public testing::Test {
protected:
    ControlTest() {
        client.subscribe();
        id = client.wait_for_state(v1::Lidar::SCANNING).id();
        client.next_sweep();
    }
    HttpAnswer post(const std::string& action, const std::string& body = "") {
        return http(gateway.http, "POST", "/api/v1/lidars/" + id + "/" + action, body);
    }

    VirtualLidarProcess lidar;
    GatewayProcess gateway{{"--lidar", lidar.port}};
    Subscriber client{"tcp://" + gateway.tcp};
    std::string id;
};

TEST_F(ControlTest, StopEndsTheStreamAndTheMotorStopsAndStartBringsItBack) {
    const auto stopped = post("stop");
    EXPECT_EQ(stopped.status, 200);
    EXPECT_THAT(stopped.body, HasSubstr("\"IDLE\""));
    lidar.process.wait_for_log("motor off");
    client.wait_for_state(v1::Lidar::IDLE);

    const auto started = post("start");
    EXPECT_EQ(started.status, 200);
    EXPECT_THAT(started.body, HasSubstr("\"SCANNING\""));
    lidar.process.wait_for_log("motor on");
    // Between the two no frame came: the next message is the state that the start brought about.
    EXPECT_FALSE(client.next().has_frame());
    client.next_sweep();
}

TEST_F(ControlTest, StartWithAModeChangesTheMode) {
    const auto answer = post("start", R"({"mode": "Standard"})");
    EXPECT_EQ(answer.status, 200);
    lidar.process.wait_for_log("scan started: Standard");
    const auto in_standard = client.next([](const auto& message) {
        return message.lidar().state() == v1::Lidar::SCANNING &&
               message.lidar().mode() == "Standard";
    });
    EXPECT_EQ(client.next_sweep().scan.mode, "Standard");
}

TEST_F(ControlTest, ResetRebootsTheLidarAndTheScanGoesOn) {
    const auto answer = post("reset");
    EXPECT_EQ(answer.status, 200);
    EXPECT_THAT(answer.body, HasSubstr("\"SCANNING\""));
    lidar.process.wait_for_log("reset");
    lidar.process.wait_for_log("scan started");
    client.wait_for_state(v1::Lidar::RESETTING);
    client.wait_for_state(v1::Lidar::SCANNING);
    EXPECT_GT(client.next_sweep().scan.gap, std::chrono::nanoseconds::zero());
}

TEST_F(ControlTest, AnUnknownModeIsRefusedAndTheScanGoesOn) {
    const auto answer = post("start", R"({"mode": "Turbo"})");
    EXPECT_EQ(answer.status, 400);
    EXPECT_THAT(answer.body, HasSubstr("unknown_mode"));
    EXPECT_THAT(answer.body, HasSubstr("Standard, Express"));
    client.next_sweep();
}

TEST_F(ControlTest, TheLatestSweepIsThereAsJsonAndCsv) {
    const auto json = http(gateway.http, "GET", "/api/v1/lidars/" + id + "/scan");
    EXPECT_EQ(json.status, 200);
    EXPECT_THAT(json.body, HasSubstr("\"angle_deg\""));
    const auto csv = http(gateway.http, "GET", "/api/v1/lidars/" + id + "/scan?format=csv");
    EXPECT_EQ(csv.status, 200);
    EXPECT_EQ(csv.header("content-type"), "text/csv; charset=utf-8");
    EXPECT_GT(std::ranges::count(csv.body, '\n'), 100);
}

TEST(Control, StartTakesTheIdOfAModeAsANumber) {
    VirtualLidarProcess listing({"--model", "s2"});
    GatewayProcess here({"--lidar", listing.port + "?name=s2"});
    Subscriber("tcp://" + here.tcp).wait_for_state(v1::Lidar::SCANNING);
    const auto answer = http(here.http, "POST", "/api/v1/lidars/s2/start", R"({"mode": 0})");
    EXPECT_EQ(answer.status, 200);
    EXPECT_THAT(answer.body, HasSubstr("\"mode\": \"Standard\""));
}

TEST(Control, AnIdleGatewayScansWhenToldTo) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8", "--idle"});
    Subscriber client("ws://" + gateway.http + "/api/v1/stream?kind=sweep");
    const auto id = client.wait_for_state(v1::Lidar::IDLE).id();
    EXPECT_EQ(http(gateway.http, "GET", "/api/v1/lidars/" + id + "/scan").status, 404);
    EXPECT_EQ(http(gateway.http, "POST", "/api/v1/lidars/" + id + "/start").status, 200);
    client.next_sweep();
}

TEST(Control, ALidarThatIsNotThereSaysWhyAndAppearsWhenItComes) {
    ScratchDirectory scratch;
    const auto port = scratch.file("lidar");
    GatewayProcess gateway({"--lidar", port});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    const auto absent = client.wait_for_state(v1::Lidar::ABSENT);
    EXPECT_THAT(absent.cause(), HasSubstr(port));
    EXPECT_NE(absent.hint(), "");
    const auto accepted = http(gateway.http, "POST", "/api/v1/lidars/lidar/start");
    EXPECT_EQ(accepted.status, 202);
    EXPECT_THAT(accepted.body, HasSubstr("\"ABSENT\""));
    EXPECT_THAT(accepted.body, HasSubstr(port));

    VirtualLidarProcess lidar({"--link", port});
    client.next_sweep();
}

TEST(Control, CommandsToALidarThatIsNotThereAreKeptExceptAReset) {
    ScratchDirectory scratch;
    const auto port = scratch.file("lidar");
    GatewayProcess gateway({"--lidar", port});
    Subscriber client("tcp://" + gateway.tcp);
    client.wait_for_state(v1::Lidar::ABSENT);
    const std::string path = "/api/v1/lidars/lidar";
    EXPECT_EQ(http(gateway.http, "PATCH", path, R"({"mode": "Standard"})").status, 202);
    EXPECT_EQ(http(gateway.http, "POST", path + "/stop").status, 202);
    EXPECT_EQ(http(gateway.http, "PATCH", path, R"({"mode": "Standard"})").status, 202);
    EXPECT_EQ(http(gateway.http, "PATCH", path, R"({"speed_hz": 8})").status, 202);
    const auto reset = http(gateway.http, "POST", path + "/reset");
    EXPECT_EQ(reset.status, 503);
    EXPECT_THAT(reset.body, HasSubstr("lidar_not_ready"));

    VirtualLidarProcess lidar({"--model", "s2", "--link", port});
    const auto idle = client.wait_for_state(v1::Lidar::IDLE);
    EXPECT_EQ(idle.mode(), "Standard");
    EXPECT_EQ(idle.rotation().wanted_hz(), 8);
}

TEST(Control, ANamedLidarGoesByItsSerialNumberAndItsPortToo) {
    ScratchDirectory scratch;
    VirtualLidarProcess lidar({"--link", scratch.file("plug")});
    GatewayProcess gateway({"--lidar", scratch.file("plug") + "?name=back"});
    Subscriber client("tcp://" + gateway.tcp);
    const auto serial = client.wait_for_state(v1::Lidar::SCANNING).device().serial_number();
    for (const auto& id : {std::string("back"), serial.substr(0, 8), serial, std::string("plug")}) {
        const auto answer = http(gateway.http, "GET", "/api/v1/lidars/" + id);
        EXPECT_EQ(answer.status, 200) << id;
        EXPECT_THAT(answer.body, HasSubstr("\"id\": \"back\"")) << id;
    }
}

TEST(Control, ALidarThatVanishesIsReportedAndTakenAgain) {
    ScratchDirectory scratch;
    const auto port = scratch.file("lidar");
    auto lidar = std::make_unique<VirtualLidarProcess>(std::vector<std::string>{"--link", port});
    GatewayProcess gateway({"--lidar", port});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    const auto before = client.next_sweep().sequence;
    // Killed, it would leave a link to what may be another's port by then.
    lidar->process.signal(SIGTERM);
    EXPECT_EQ(lidar->process.wait(), 0);
    client.wait_for_state(v1::Lidar::BACKING_OFF);
    const auto absent = client.wait_for_state(v1::Lidar::ABSENT);
    EXPECT_TRUE(absent.has_failing_since());
    lidar = std::make_unique<VirtualLidarProcess>(std::vector<std::string>{"--link", port});
    const auto after = client.next_sweep();
    EXPECT_GT(after.sequence, before);
    EXPECT_GE(client.wait_for_state(v1::Lidar::SCANNING).recoveries(), 1U);
}

TEST(Control, AGatewayThatWasHeldUpTakesItForNoFaultOfTheLidar) {
    // So fast that less than a revolution waits when the gateway goes on.
    VirtualLidarProcess lidar({"--model", "s2"});
    GatewayProcess gateway({"--lidar", lidar.port});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    client.next_sweep();
    gateway.process.signal(SIGSTOP);
    for (int second = 0; second < 3; ++second) {  // it says so once a second
        lidar.process.wait_for_log("the host does not read");
    }
    const auto held_up_until = std::chrono::steady_clock::now();
    gateway.process.signal(SIGCONT);
    // A recovery would come before the first sweep that was measured after the hold-up.
    while (client.next_sweep().scan.sweep.samples.front().time < held_up_until) {
    }
    EXPECT_THAT(http(gateway.http, "GET", "/api/v1/lidars").body, HasSubstr("\"recoveries\": 0"));
}

TEST(Control, AMotorRestsWhileNobodyWatchesAndTurnsForTheFirstWhoDoes) {
    VirtualLidarProcess lidar;
    GatewayProcess gateway({"--lidar", lidar.port + "?name=mine&motor_off_after=1"});
    lidar.process.wait_for_log("scan started");
    lidar.process.wait_for_log("motor off");
    Subscriber("tcp://" + gateway.tcp).wait_for_lidar([](const auto& mine) {  // asks for no frame
        return mine.state() == v1::Lidar::IDLE &&
               mine.cause().find("nobody watches, so its motor is off") != std::string::npos;
    });
    EXPECT_EQ(http(gateway.http, "POST", "/api/v1/lidars/mine/start").status, 200)
        << "it is to scan already";
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    client.wait_for_state(v1::Lidar::SCANNING);
    client.next_sweep();
    EXPECT_EQ(http(gateway.http, "POST", "/api/v1/lidars/mine/stop").status, 200);
    client.wait_for_lidar([](const auto& mine) {
        return mine.state() == v1::Lidar::IDLE && mine.cause().empty();  // its user stopped it
    });
}

TEST(Control, APatchThatIsRefusedInOnePartChangesNothing) {
    GatewayProcess gateway({"--lidar", "virtual:s2?name=left"});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    client.wait_for_state(v1::Lidar::SCANNING);
    const std::string lidar = "/api/v1/lidars/left";
    const auto before = http(gateway.http, "PATCH", lidar, R"({"speed_hz": 12})");
    EXPECT_THAT(before.body, HasSubstr("\"wanted_hz\": 12,"));
    const auto refused = http(gateway.http, "PATCH", lidar, R"({"speed_hz": 8, "mode": "Turbo"})");
    EXPECT_EQ(refused.status, 400);
    EXPECT_THAT(refused.body, HasSubstr("unknown_mode"));
    EXPECT_THAT(http(gateway.http, "GET", lidar).body, HasSubstr("\"wanted_hz\": 12,"));
}

TEST(Control, ANameThatItsUserGaveALidarIsNotTakenByThePortOfAnother) {
    ScratchDirectory scratch;
    GatewayProcess gateway({"--lidar", scratch.file("left"), "--lidar", "virtual:a1m8?name=left"});
    const auto named = http(gateway.http, "GET", "/api/v1/lidars/left");
    EXPECT_THAT(named.body, HasSubstr("virtual:a1m8?name=left"));
    EXPECT_THAT(
        http(gateway.http, "GET", "/api/v1/lidars/left-1").body,
        HasSubstr(scratch.file("left"))
    );
}

}  // namespace
}  // namespace sweepcast::test
