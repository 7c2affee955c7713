// Every row of what the checks of a diagnosis conclude: what was seen, and what a user is told.
#include "driver/device/error.hpp"
#include "driver/diagnosis/answer_findings.hpp"
#include "driver/diagnosis/port_findings.hpp"
#include "driver/diagnosis/scan_findings.hpp"
#include "driver/link/error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <ostream>
#include <sys/stat.h>

namespace sweepcast::diagnosis {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr auto path = "/dev/ttyUSB0";

link::SerialPort adapter(std::uint16_t vendor, std::uint16_t product, const std::string& name) {
    link::SerialPort port;
    port.path = path;
    port.vendor_id = vendor;
    port.product_id = product;
    port.product = name;
    return port;
}

PortLook a_port(int error = 0) {
    PortLook port;
    port.path = path;
    port.error = error;
    port.facts.mode = S_IFCHR | 0660;
    port.facts.group = "dialout";
    port.facts.user = "ada";
    port.facts.own_pid = 1;
    port.facts.ports = {adapter(0x10c4, 0xea60, "CP2102")};
    return port;
}

Heard heard(std::uint32_t baud, HeardKind kind, std::size_t bytes = 100) {
    Heard result;
    result.baud = baud;
    result.kind = kind;
    result.bytes = kind == HeardKind::nothing ? 0 : bytes;
    return result;
}

LineLook a_line(std::vector<Heard> what) {
    LineLook line;
    line.url = path;
    line.heard = std::move(what);
    return line;
}

LineLook silent_line() {
    return a_line({heard(115200, HeardKind::nothing), heard(256000, HeardKind::nothing)});
}

SpinLook a_spin() {
    SpinLook spin;
    spin.model = "A1M8";
    spin.control = protocol::MotorControl::modem_line;
    spin.mode = "Express";
    spin.accepted = true;
    spin.waited = 6s;
    spin.health_after = protocol::Health{};
    return spin;
}

QualityLook quality(std::uint64_t damaged, std::uint64_t lost = 0, std::uint64_t skipped = 0) {
    QualityLook look;
    look.type = protocol::AnswerType::express;
    look.line.baud = 115200;
    look.line.bytes = 84'000;  // a thousand packets
    look.line.samples = 32'000;
    look.line.checksum_errors = damaged;
    look.line.lost_packets = lost;
    look.line.skipped_bytes = skipped;
    return look;
}

device::Rotation rotation(double measured, double wanted) {
    device::Rotation value;
    value.measured_hz = measured;
    value.wanted_hz = wanted;
    return value;
}

/// A row: a case, and what must come out of it. Empty texts: not looked at.
struct Row {
    std::string name;
    Finding finding;
    Step step;
    Verdict verdict;
    std::string cause;
    std::string likeliest;
    std::string next_step;
};

std::vector<Row> port_rows() {
    auto missing = a_port(ENOENT);
    missing.facts.mode.reset();
    auto gone_virtual = missing;
    gone_virtual.path = "/tmp/lidar";
    auto no_ports = missing;
    no_ports.facts.ports.clear();
    auto member = a_port(EACCES);
    member.facts.member = true;
    auto held = a_port();
    held.facts.holders = {{812, "ModemManager"}};
    auto emulated = a_port();
    emulated.facts.holders = {{812, "python3", true}};
    auto held_by_gateway = a_port();
    held_by_gateway.facts.holders = {{900, "sweepcast"}};
    return {
        {"PortThere", judge_port(a_port()), Step::port, Verdict::ok, "", "", ""},
        {"PortMissing",
         judge_port(missing),
         Step::port,
         Verdict::failed,
         "there is no port /dev/ttyUSB0",
         "another name",
         "the only USB serial port here is"},
        {"NoPortsAtAll",
         judge_port(no_ports),
         Step::port,
         Verdict::failed,
         "there is no port /dev/ttyUSB0",
         "charging cable",
         "dmesg"},
        {"VirtualPortGone",
         judge_port(gone_virtual),
         Step::port,
         Verdict::failed,
         "there is no port /tmp/lidar",
         "has ended",
         "sweepcast virtual --link /tmp/lidar"},
        {"Allowed", judge_permission(a_port()), Step::permission, Verdict::ok, "", "", ""},
        {"NotInGroup",
         judge_permission(a_port(EACCES)),
         Step::permission,
         Verdict::failed,
         "group dialout",
         "members of one group",
         "sudo usermod -aG dialout ada"},
        {"NotLoggedInAgain",
         judge_permission(member),
         Step::permission,
         Verdict::failed,
         "this login does not know yet",
         "when it began",
         "log out and in again"},
        {"ForbiddenInContainer",
         judge_permission(a_port(EPERM)),
         Step::permission,
         Verdict::failed,
         "the system forbids",
         "container",
         "--device=/dev/ttyUSB0"},
        {"Free", judge_holder(a_port(), false), Step::holder, Verdict::ok, "", "", ""},
        {"Emulated", judge_holder(emulated, false), Step::holder, Verdict::ok, "", "", ""},
        {"HeldWithoutALock",
         judge_holder(held, false),
         Step::holder,
         Verdict::failed,
         "in use by ModemManager (process 812)",
         "",
         "systemctl disable --now ModemManager"},
        {"HeldByAGateway",
         judge_holder(held_by_gateway, true),
         Step::holder,
         Verdict::failed,
         "in use by sweepcast (process 900)",
         "",
         "/api/v1/lidars"},
        {"HeldByAnUnseenProcess",
         judge_failed_opening(a_port(), {link::errc::port_busy, "", ""}),
         Step::holder,
         Verdict::failed,
         "by a process of another user",
         "",
         "sudo fuser -v /dev/ttyUSB0"},
        {"NotSerial",
         judge_failed_opening(
             a_port(),
             {link::errc::not_a_serial_port, "/etc/passwd is a regular file", "the ports are"}
         ),
         Step::open,
         Verdict::failed,
         "regular file",
         "misspelt",
         "the ports are"},
        {"AdapterTooSlow",
         judge_failed_opening(a_port(), link::explain_baud(path, 1000000, 921600)),
         Step::open,
         Verdict::failed,
         "cannot run at 1000000 baud",
         "older than the lidar",
         "CP2102N"},
        {"Vanishing",
         judge_failed_opening(a_port(), {link::errc::port_not_found, "gone", "look"}),
         Step::port,
         Verdict::failed,
         "gone",
         "",
         ""},
        {"InputOutputError",
         judge_failed_opening(a_port(), link::explain_open_error(path, EIO, a_port().facts)),
         Step::open,
         Verdict::failed,
         "no working serial hardware",
         "bad state",
         ""},
        {"NetworkRefused",
         judge_failed_connection(
             "tcp://10.0.0.2:20108",
             {link::errc::disconnected, "10.0.0.2 refuses", "start it"}
         ),
         Step::open,
         Verdict::failed,
         "10.0.0.2 refuses",
         "is off",
         "start it"},
        {"NoCandidates",
         judge_no_port({}),
         Step::port,
         Verdict::failed,
         "no port",
         "not plugged in",
         "dmesg"},
        {"OnlyOtherAdapters",
         judge_no_port({adapter(0x0403, 0x6001, "FT232R")}),
         Step::port,
         Verdict::failed,
         "no port",
         "another kind: /dev/ttyUSB0: FT232R (0403:6001)",
         "sweepcast doctor /dev/ttyUSB0"},
    };
}

std::vector<Row> answer_rows() {
    auto answering = heard(256000, HeardKind::answer, 27);
    answering.info = protocol::DeviceInfo{};
    answering.info->model = 0x2C;
    auto forced = a_line({heard(115200, HeardKind::noise), answering});
    forced.asked_baud = 115200;
    auto network = a_line({heard(0, HeardKind::nothing)});
    network.network = true;
    network.url = "udp://192.168.11.2:8089";
    auto noisy = a_line({heard(115200, HeardKind::noise), heard(256000, HeardKind::noise)});
    auto noisy_on_ch340 = noisy;
    noisy_on_ch340.adapter = adapter(0x1a86, 0x7523, "USB Serial");
    auto banner = heard(115200, HeardKind::boot_text);
    banner.text = "RP LIDAR System.";
    banner.boots = 3;
    auto gps = heard(115200, HeardKind::text);
    gps.text = "$GPGGA";
    return {
        {"Heard", judge_bytes(a_line({answering})), Step::bytes, Verdict::ok, "", "", ""},
        {"Silence",
         judge_bytes(silent_line()),
         Step::bytes,
         Verdict::failed,
         "not a byte came at 115200 or 256000 baud",
         "no power",
         "does its motor turn"},
        {"SilenceOnTheNetwork",
         judge_bytes(network),
         Step::bytes,
         Verdict::failed,
         "nothing answers at udp://192.168.11.2:8089",
         "off",
         "ip addr"},
        {"WrongBaud",
         judge_bytes(forced),
         Step::bytes,
         Verdict::failed,
         "(A2M12) speaks at 256000 baud, not at 115200",
         "another model",
         "?baud=256000"},
        {"Noise",
         judge_bytes(noisy),
         Step::bytes,
         Verdict::failed,
         "make no sense at 115200 or",
         "disturbed",
         "short"},
        {"NoiseOnACh340",
         judge_bytes(noisy_on_ch340),
         Step::bytes,
         Verdict::failed,
         "make no sense",
         "CH340",
         "came with the lidar"},
        {"Answered",
         judge_descriptor(a_line({answering})),
         Step::descriptor,
         Verdict::ok,
         "",
         "",
         ""},
        {"BootTextIsHeard", judge_bytes(a_line({banner})), Step::bytes, Verdict::ok, "", "", ""},
        {"BootTextOnly",
         judge_descriptor(a_line({banner})),
         Step::descriptor,
         Verdict::failed,
         "boots, 3 times while we listened, and answers nothing",
         "supply breaks down",
         "5 V with 1.5 A"},
        {"DeafLidar",
         judge_descriptor(a_line({heard(115200, HeardKind::scan_data)})),
         Step::descriptor,
         Verdict::failed,
         "does not hear us",
         "TX to the lidar's RX",
         "check the wire"},
        {"AnotherDevice",
         judge_descriptor(a_line({gps})),
         Step::descriptor,
         Verdict::failed,
         "another device speaks on /dev/ttyUSB0",
         "GPS receiver",
         "/dev/serial/by-id"},
        {"Info", judge_info(protocol::DeviceInfo{}, ""), Step::info, Verdict::ok, "", "", ""},
        {"InfoBrokenOff",
         judge_info(std::nullopt, ""),
         Step::info,
         Verdict::failed,
         "does not come whole",
         "lost on the line",
         "cable"},
        {"Good", judge_health(protocol::Health{}), Step::health, Verdict::ok, "", "", ""},
        {"Warning",
         judge_health(protocol::Health{protocol::HealthStatus::warning, 0x12}),
         Step::health,
         Verdict::warning,
         "code 0x0012",
         "",
         "ask the maker"},
        {"ProtectionStop",
         judge_health(protocol::Health{protocol::HealthStatus::error, 0x8001}),
         Step::health,
         Verdict::failed,
         "protection stop (error code 0x8001)",
         "blocks its head",
         "turn the head by hand"},
        {"HealthUnanswered",
         judge_health(make_error_code(device::errc::no_answer)),
         Step::health,
         Verdict::failed,
         "not how it is",
         "",
         ""},
        {"Modes",
         judge_modes(std::vector{device::ScanMode{.name = "Boost", .sample_duration = 125us}}),
         Step::modes,
         Verdict::ok,
         "",
         "",
         ""},
        {"NoModes",
         judge_modes(std::vector<device::ScanMode>{}),
         Step::modes,
         Verdict::failed,
         "how it can scan",
         "",
         ""},
    };
}

std::vector<Row> scan_rows() {
    auto spinning = a_spin();
    spinning.samples = 9;
    spinning.waited = 1200ms;
    auto gone = a_spin();
    gone.gone = true;
    auto booted = a_spin();
    booted.heard = heard(115200, HeardKind::boot_text);
    auto stopped = a_spin();
    stopped.health_after = protocol::Health{protocol::HealthStatus::error, 7};
    auto refused = a_spin();
    refused.accepted = false;
    auto fell_silent = refused;
    fell_silent.health_after.reset();
    auto board = a_spin();
    board.control = protocol::MotorControl::accessory_board;
    auto rpm = a_spin();
    rpm.control = protocol::MotorControl::rpm;
    auto garbled = a_spin();
    garbled.heard = heard(115200, HeardKind::noise);
    auto at_460800_on_ch340 = quality(100);
    at_460800_on_ch340.line.baud = 460800;
    at_460800_on_ch340.adapter = adapter(0x1a86, 0x7523, "USB Serial");
    auto wireless = quality(0, 100);
    wireless.line.baud = 0;
    auto not_obeyed = rotation(10, 10);
    not_obeyed.warning = "the speed of a C1 cannot be changed";
    return {
        {"Spinning", judge_motor(spinning), Step::motor, Verdict::ok, "", "", ""},
        {"PulledDown",
         judge_motor(gone),
         Step::motor,
         Verdict::failed,
         "connection broke",
         "more current",
         "over-current"},
        {"BrownOut",
         judge_motor(booted),
         Step::motor,
         Verdict::failed,
         "booted again when its motor started",
         "supply",
         "1.5 A"},
        {"ProtectedItself",
         judge_motor(stopped),
         Step::motor,
         Verdict::failed,
         "protection stop when its motor started (error code 0x0007)",
         "blocks",
         ""},
        {"Refused",
         judge_motor(refused),
         Step::motor,
         Verdict::failed,
         "does not accept a scan in mode Express",
         "",
         "--mode Standard"},
        {"FellSilent",
         judge_motor(fell_silent),
         Step::motor,
         Verdict::failed,
         "fell silent",
         "supply",
         ""},
        {"StalledA1",
         judge_motor(a_spin()),
         Step::motor,
         Verdict::failed,
         "the motor does not turn",
         "VMOTO",
         "does it turn"},
        {"StalledOnABoard",
         judge_motor(board),
         Step::motor,
         Verdict::failed,
         "the motor does not turn",
         "board",
         ""},
        {"StalledByItself",
         judge_motor(rpm),
         Step::motor,
         Verdict::failed,
         "the motor does not turn",
         "supply",
         ""},
        {"Garbled",
         judge_motor(garbled),
         Step::motor,
         Verdict::failed,
         "nothing of it arrives whole",
         "disturbed",
         "grounds"},
        {"Sweeps", judge_sweep({2, 400, 380, 1s}), Step::sweep, Verdict::ok, "", "", ""},
        {"NoSweep",
         judge_sweep({0, 400, 0, 3s}),
         Step::sweep,
         Verdict::failed,
         "do not make a revolution",
         "lost on the line",
         ""},
        {"SeesNothing",
         judge_sweep({2, 400, 0, 1s}),
         Step::sweep,
         Verdict::warning,
         "sees nothing",
         "film or cap",
         "sheet of paper"},
        {"Clean", judge_quality(quality(4)), Step::quality, Verdict::ok, "", "", ""},
        {"Disturbed",
         judge_quality(quality(5)),
         Step::quality,
         Verdict::warning,
         "disturbed: 0.5 %",
         "cable",
         "cable"},
        {"Bad",
         judge_quality(quality(50)),
         Step::quality,
         Verdict::failed,
         "bad: 5 %",
         "cable",
         "cable"},
        {"SkippedBytesCountToo",
         judge_quality(quality(0, 0, 8'400)),
         Step::quality,
         Verdict::failed,
         "bad: 10 %",
         "cable",
         ""},
        {"Lossy",
         judge_quality(quality(1, 100)),
         Step::quality,
         Verdict::failed,
         "bad",
         "into the computer",
         ""},
        {"LossyNetwork",
         judge_quality(wireless),
         Step::quality,
         Verdict::failed,
         "bad",
         "datagrams",
         "by cable"},
        {"BadAt460800OnACh340",
         judge_quality(at_460800_on_ch340),
         Step::quality,
         Verdict::failed,
         "bad",
         "not good enough for 460800",
         ""},
        {"AtItsSpeed", judge_speed(rotation(9.6, 10)), Step::speed, Verdict::ok, "", "", ""},
        {"TooSlow",
         judge_speed(rotation(7.9, 10)),
         Step::speed,
         Verdict::warning,
         "too slowly",
         "voltage",
         "by hand"},
        {"TooFast",
         judge_speed(rotation(12.1, 10)),
         Step::speed,
         Verdict::warning,
         "too fast",
         "full supply",
         ""},
        {"PlausibleWithoutAWish",
         judge_speed(rotation(5.5, 0)),
         Step::speed,
         Verdict::ok,
         "",
         "",
         ""},
        {"TooSlowWithoutAWish",
         judge_speed(rotation(1.9, 0)),
         Step::speed,
         Verdict::warning,
         "too slowly",
         "",
         ""},
        {"NotMeasured", judge_speed(rotation(0, 10)), Step::speed, Verdict::ok, "", "", ""},
        {"NotObeyed",
         judge_speed(not_obeyed),
         Step::speed,
         Verdict::warning,
         "cannot be changed",
         "",
         ""},
    };
}

class FindingsTest : public testing::TestWithParam<Row> {};

void PrintTo(const Row& row, std::ostream* out) {
    *out << row.name;
}

TEST_P(FindingsTest, SaysWhatIsWrongWhyAndWhatToDo) {
    const auto& row = GetParam();
    const auto& finding = row.finding;
    EXPECT_EQ(finding.step, row.step);
    EXPECT_EQ(finding.verdict, row.verdict);
    EXPECT_NE(finding.seen, "");
    if (row.verdict == Verdict::ok) {
        EXPECT_EQ(finding.cause, "");
        return;
    }
    EXPECT_THAT(finding.cause, HasSubstr(row.cause));
    EXPECT_NE(finding.cause, "");
    EXPECT_THAT(finding.cause, Not(HasSubstr("\n")));
    if (!row.likeliest.empty()) {
        ASSERT_FALSE(finding.likely_causes.empty());
        EXPECT_THAT(finding.likely_causes.front(), HasSubstr(row.likeliest));
    }
    if (!row.next_step.empty()) {
        EXPECT_THAT(finding.next_steps, Contains(HasSubstr(row.next_step)));
    }
    EXPECT_THAT(finding.next_steps, Not(Contains("")));
}

std::string name_of(const testing::TestParamInfo<Row>& info) {
    return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Port, FindingsTest, testing::ValuesIn(port_rows()), name_of);
INSTANTIATE_TEST_SUITE_P(Answer, FindingsTest, testing::ValuesIn(answer_rows()), name_of);
INSTANTIATE_TEST_SUITE_P(Scan, FindingsTest, testing::ValuesIn(scan_rows()), name_of);

TEST(Findings, APortIsDescribedByItsAdapter) {
    EXPECT_EQ(judge_port(a_port()).seen, "/dev/ttyUSB0: CP2102 (10c4:ea60)");
}

TEST(Findings, ImpossibleSpeedsAreNamedAndBlamed) {
    auto line = silent_line();
    line.heard.push_back(heard(1000000, HeardKind::nothing));
    line.heard.back().possible = false;
    const auto finding = judge_bytes(line);
    EXPECT_THAT(finding.seen, HasSubstr("1000000 baud is not possible with this adapter"));
    EXPECT_THAT(finding.likely_causes, Contains(HasSubstr("S2 or S3 1000000")));
}

TEST(Findings, AnAliasStandsBesideTheModel) {
    protocol::DeviceInfo info;
    info.model = 0x31;
    EXPECT_THAT(judge_info(info, "A3M1-R1").seen, HasSubstr("A3M1 (A3M1-R1)"));
}

}  // namespace
}  // namespace sweepcast::diagnosis
