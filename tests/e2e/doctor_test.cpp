// The doctor names what is wrong: the real program at real ports with real faults.
#include "sweepcast/v1/api.pb.h"
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace sweepcast::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

v1::Diagnosis parse(const std::string& json) {
    v1::Diagnosis diagnosis;
    const auto parsed = google::protobuf::util::JsonStringToMessage(json, &diagnosis);
    EXPECT_TRUE(parsed.ok()) << parsed.ToString() << "\n" << json;
    return diagnosis;
}

struct Told {
    int exit_code{};
    v1::Diagnosis diagnosis;
};

/// What `command`, a doctor with --json, says.
Told told_by(const std::vector<std::string>& command) {
    Process doctor(command);
    const int exit_code = doctor.wait();
    return {exit_code, parse(doctor.rest_of_output())};
}

Told doctor(const std::string& url) {
    return told_by({program(), "doctor", "--json", url});
}

/// The id of the check that failed; empty if none did.
std::string failed_check(const v1::Diagnosis& diagnosis) {
    for (const auto& check : diagnosis.checks()) {
        if (check.verdict() == v1::Diagnosis::FAILED) {
            return check.id();
        }
    }
    return "";
}

void expect_failure(const Told& told, const std::string& check, const std::string& cause) {
    const auto& diagnosis = told.diagnosis;
    EXPECT_EQ(told.exit_code, 1);
    EXPECT_EQ(diagnosis.verdict(), v1::Diagnosis::FAILED);
    EXPECT_EQ(failed_check(diagnosis), check);
    EXPECT_THAT(diagnosis.cause(), HasSubstr(cause));
    EXPECT_FALSE(diagnosis.likely_causes().empty());
    EXPECT_FALSE(diagnosis.next_steps().empty());
    EXPECT_EQ(diagnosis.checks_size(), 13) << "those not run are told, too";
}

// ---- healthy ones

class HealthyTest : public testing::TestWithParam<std::string> {};

TEST_P(HealthyTest, PassesEveryCheckAndIsLeftAtRest) {
    const ScratchDirectory scratch;
    const auto control = scratch.file("control");
    std::unique_ptr<VirtualLidarProcess> lidar;
    Told told;
    for (int runs = 0; lidar == nullptr || !lost_nothing(control); ++runs) {
        ASSERT_LT(runs, most_runs) << "the machine is too busy to read a lidar";
        lidar.reset();
        lidar = std::make_unique<VirtualLidarProcess>(
            std::vector<std::string>{"--model", GetParam(), "--control", control}
        );
        told = doctor(lidar->port);
    }
    const auto& [exit_code, diagnosis] = told;
    EXPECT_EQ(exit_code, 0);
    EXPECT_EQ(diagnosis.verdict(), v1::Diagnosis::OK) << diagnosis.cause();
    EXPECT_EQ(diagnosis.checks_size(), 13);
    for (const auto& check : diagnosis.checks()) {
        EXPECT_EQ(check.verdict(), v1::Diagnosis::OK) << check.id() << ": " << check.finding();
    }
    EXPECT_EQ(diagnosis.cause(), "");
    lidar->process.wait_for_log("scan stopped");
    lidar->process.wait_for_log("motor off");
    lidar->process.wait_for_log("closed by the host");
}

INSTANTIATE_TEST_SUITE_P(
    Families,
    HealthyTest,
    testing::Values("a1m8", "s2"),
    [](const auto& lidar) { return lidar.param; }
);

TEST(Doctor, ExaminesALidarOnTheNetworkWithoutThePortsChecks) {
    VirtualLidarProcess lidar({"--model", "t1", "--listen", "udp://127.0.0.1:0"});
    const auto [exit_code, diagnosis] = doctor(lidar.port);
    EXPECT_EQ(exit_code, 0) << diagnosis.cause();
    EXPECT_EQ(diagnosis.verdict(), v1::Diagnosis::OK) << diagnosis.cause();
    ASSERT_EQ(diagnosis.checks_size(), 10);
    EXPECT_EQ(diagnosis.checks(0).id(), "open");
}

// ---- the faults, one after the other along the chain

TEST(DoctorFault, NoSuchPort) {
    expect_failure(doctor("/dev/ttyUSB77"), "port", "there is no port /dev/ttyUSB77");
}

/// As another user if we are root, to whom nothing is forbidden.
TEST(DoctorFault, NoPermission) {
    VirtualLidarProcess lidar;
    if (::geteuid() != 0) {
        ASSERT_EQ(::chmod(lidar.port.c_str(), 0), 0);
        expect_failure(doctor(lidar.port), "permission", "may not open " + lidar.port);
        return;
    }
    ASSERT_TRUE(fs::exists("/usr/bin/setpriv")) << "part of Debian's util-linux";
    ASSERT_EQ(::chmod(lidar.port.c_str(), 0600), 0);
    const ScratchDirectory scratch;  // where the other user can read
    const auto copy = scratch.file("sweepcast");
    fs::copy_file(program(), copy);
    ASSERT_EQ(::chmod(copy.c_str(), 0755), 0);
    ASSERT_EQ(::chmod(fs::path(copy).parent_path().c_str(), 0755), 0);
    const auto told = told_by(
        {"/usr/bin/setpriv",
         "--reuid=65534",
         "--regid=65534",
         "--clear-groups",
         copy,
         "doctor",
         "--json",
         lidar.port}
    );
    expect_failure(told, "permission", "may not open " + lidar.port);
}

TEST(DoctorFault, PortHeldByAnotherProcess) {
    VirtualLidarProcess lidar;
    const int held = ::open(lidar.port.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    ASSERT_GE(held, 0);
    const auto told = doctor(lidar.port);
    ::close(held);
    expect_failure(told, "holder", "e2e_test (process " + std::to_string(::getpid()) + ")");
}

TEST(DoctorFault, WrongBaudInTheUrl) {
    VirtualLidarProcess lidar({"--model", "a3m1"});
    const auto told = doctor(lidar.port + "?baud=115200");
    expect_failure(told, "bytes", "the lidar (A3M1) speaks at 256000 baud, not at 115200");
    EXPECT_THAT(told.diagnosis.next_steps(0), HasSubstr("?baud=256000"));
}

struct Fault {
    std::string name;
    std::vector<std::string> options;
    std::string check;
    std::string cause;
    std::string likely;  ///< in the likeliest cause
};

class DoctorFaultTest : public testing::TestWithParam<Fault> {};

TEST_P(DoctorFaultTest, IsNamed) {
    const auto& fault = GetParam();
    VirtualLidarProcess lidar(fault.options);
    const auto told = doctor(lidar.port);
    expect_failure(told, fault.check, fault.cause);
    EXPECT_THAT(told.diagnosis.likely_causes(0), HasSubstr(fault.likely));
}

INSTANTIATE_TEST_SUITE_P(
    Chain,
    DoctorFaultTest,
    testing::Values(
        Fault{
            "AnAdapterThatGarbles",
            {"--fault", "noise=0.9"},
            "bytes",
            "they make no sense",
            "disturbed"},
        Fault{"NothingAnswers", {"--fault", "mute"}, "bytes", "nothing answers on", "no power"},
        Fault{
            "BootTextOnly",
            {"--fault", "banner"},
            "descriptor",
            "the lidar says that it boots",
            "supply"},
        Fault{
            "HealthError",
            {"--fault", "protection-stop=0x8001"},
            "health",
            "protection stop (error code 0x8001)",
            "blocks its head"},
        Fault{
            "MotorStalled",
            {"--fault", "motor-stall"},
            "motor",
            "the motor does not turn",
            "no 5 V of its own"},
        Fault{"NoisyLine", {"--fault", "noise=0.003"}, "quality", "the line is bad", ""}
    ),
    [](const auto& fault) { return fault.param.name; }
);

TEST(Doctor, WarnsOfWhatStillWorks) {
    VirtualLidarProcess lidar({"--fault", "warning=0x8002"});
    const auto [exit_code, diagnosis] = doctor(lidar.port);
    EXPECT_EQ(exit_code, 0);
    EXPECT_EQ(diagnosis.verdict(), v1::Diagnosis::WARNING);
    EXPECT_THAT(diagnosis.cause(), HasSubstr("0x8002"));
}

// ---- as a command

TEST(Doctor, SpeaksToPeopleInWordsWithoutColour) {
    VirtualLidarProcess lidar({"--fault", "protection-stop"});
    Process doctor({program(), "doctor", lidar.port});
    EXPECT_EQ(doctor.wait(), 1);
    const auto text = doctor.rest_of_output();
    EXPECT_THAT(text, StartsWith("Examining " + lidar.port + "\n"));
    EXPECT_THAT(text, HasSubstr("\n  ok    It says what it is: A1M8"));
    EXPECT_THAT(text, HasSubstr("\n  FAIL  It is healthy: error"));
    EXPECT_THAT(text, HasSubstr("\n  -     The line is clean\n"));
    EXPECT_THAT(text, HasSubstr("\nWhat is wrong: the lidar is in protection stop"));
    EXPECT_THAT(text, HasSubstr("\nWhy, most likely:\n  1. "));
    EXPECT_THAT(text, HasSubstr("\nWhat to do:\n  1. "));
    EXPECT_THAT(text, Not(HasSubstr("\x1b")));
}

TEST(Doctor, WithoutAUrlExaminesThePortsThatServeWouldLookAt) {
    const ScratchDirectory scratch;
    VirtualLidarProcess well({"--link", scratch.file("lidar-a")});
    VirtualLidarProcess mute({"--link", scratch.file("lidar-b"), "--fault", "mute"});
    Process doctor({program(), "doctor", "--json", "--discover", scratch.file("lidar-*")});
    EXPECT_EQ(doctor.wait(), 1);
    const auto lines = doctor.rest_of_output();
    const auto second = lines.find('\n') + 1;
    EXPECT_EQ(parse(lines.substr(0, second)).verdict(), v1::Diagnosis::OK);
    EXPECT_EQ(failed_check(parse(lines.substr(second))), "bytes");
}

TEST(Doctor, StopsTidilyInMidScan) {
    VirtualLidarProcess lidar;
    Process doctor({program(), "doctor", lidar.port});
    lidar.process.wait_for_log("scan started");
    doctor.signal(SIGINT);
    EXPECT_EQ(doctor.wait(), 130);
    lidar.process.wait_for_log("scan stopped");
    lidar.process.wait_for_log("motor off");
    lidar.process.wait_for_log("closed by the host");
    EXPECT_THAT(doctor.rest_of_output(), Not(HasSubstr("FAIL")));
}

TEST(Doctor, LeavesALidarThatScansForAGatewayAlone) {
    VirtualLidarProcess lidar;
    GatewayProcess gateway({"--lidar", lidar.port});
    Subscriber subscriber("tcp://" + gateway.tcp);
    subscriber.subscribe();
    const auto before = subscriber.next_sweep().sequence;
    const auto told = doctor(lidar.port);
    expect_failure(
        told,
        "holder",
        "in use by sweepcast (process " + std::to_string(gateway.process.pid()) + ")"
    );
    EXPECT_EQ(subscriber.next_sweep().sequence, before + 1) << "the scan went on";
}

// ---- as part of the API

/// The diagnosis of the gateway's only lidar.
v1::Diagnosis diagnosis_of(const GatewayProcess& gateway, const std::string& id) {
    const auto answer = http(gateway.http, "GET", "/api/v1/lidars/" + id + "/diagnosis");
    EXPECT_EQ(answer.status, 200) << answer.body;
    return parse(answer.body);
}

TEST(DiagnosisApi, TellsOfALidarThatScansWithoutDisturbingIt) {
    VirtualLidarProcess lidar;
    GatewayProcess gateway({"--lidar", lidar.port + "?name=mine"});
    Subscriber subscriber("tcp://" + gateway.tcp);
    subscriber.subscribe();
    const auto before = subscriber.next_sweep().sequence;
    const auto diagnosis = diagnosis_of(gateway, "mine");
    EXPECT_EQ(diagnosis.checks_size(), 13);
    for (const auto& check : diagnosis.checks()) {
        EXPECT_EQ(check.verdict(), v1::Diagnosis::OK) << check.id() << ": " << check.finding();
    }
    EXPECT_EQ(subscriber.next_sweep().sequence, before + 1);
    EXPECT_EQ(subscriber.next_sweep().sequence, before + 2);
}

TEST(DiagnosisApi, TellsOfAProtectionStop) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8?fault=protection-stop=0x8001&name=mine"});
    Subscriber subscriber("tcp://" + gateway.tcp);
    subscriber.wait_for_state(v1::Lidar::PROTECTION_STOP);
    const auto diagnosis = diagnosis_of(gateway, "mine");
    EXPECT_EQ(failed_check(diagnosis), "health");
    EXPECT_THAT(diagnosis.cause(), HasSubstr("0x8001"));
}

TEST(DiagnosisApi, ExaminesALidarThatIsNotInHand) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8?fault=banner&name=mine"});
    const auto diagnosis = diagnosis_of(gateway, "mine");
    EXPECT_EQ(failed_check(diagnosis), "descriptor");
    EXPECT_THAT(diagnosis.cause(), HasSubstr("boots"));
}

TEST(DiagnosisApi, TellsOfAMotorThatIsStartedInVain) {
    GatewayProcess gateway({"--lidar", "virtual:a3m1?fault=motor-stall&name=mine"});
    Subscriber subscriber("tcp://" + gateway.tcp);
    subscriber.wait_for_state(v1::Lidar::STARTING);
    const auto diagnosis = diagnosis_of(gateway, "mine");
    EXPECT_EQ(failed_check(diagnosis), "motor");
    EXPECT_THAT(diagnosis.cause(), HasSubstr("the motor does not turn"));
    EXPECT_THAT(diagnosis.likely_causes(0), HasSubstr("board between lidar and USB"));
}

TEST(DiagnosisApi, ExaminesAPortThatIsNotThere) {
    GatewayProcess gateway({"--lidar", "/dev/ttyUSB77"});
    EXPECT_EQ(failed_check(diagnosis_of(gateway, "ttyUSB77")), "port");
    const auto posted = http(gateway.http, "POST", "/api/v1/lidars/ttyUSB77/diagnosis");
    EXPECT_EQ(posted.status, 405);
    EXPECT_EQ(posted.header("allow"), "GET, HEAD");
    const auto head = http(gateway.http, "HEAD", "/api/v1/lidars/ttyUSB77/diagnosis");
    EXPECT_EQ(head.status, 200);
    EXPECT_EQ(head.body, "");
}

TEST(DiagnosisApi, AnIdleLidarStaysAtRest) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8?fault=motor-stall&name=mine", "--idle"});
    Subscriber subscriber("tcp://" + gateway.tcp);
    subscriber.wait_for_state(v1::Lidar::IDLE);
    // Idle is in hand: nothing has to be found out, and nothing may turn.
    const auto diagnosis = diagnosis_of(gateway, "mine");
    EXPECT_EQ(diagnosis.verdict(), v1::Diagnosis::OK);
    EXPECT_EQ(diagnosis.checks(9).id(), "motor");
    EXPECT_EQ(diagnosis.checks(9).verdict(), v1::Diagnosis::NOT_RUN);
}

}  // namespace
}  // namespace sweepcast::test
