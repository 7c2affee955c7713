// What an operator is told when a port cannot be opened.
#include "driver/link/open_problem.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <sys/stat.h>

namespace sweepcast::link {
namespace {

using testing::HasSubstr;

const std::string path = "/dev/ttyUSB0";

PortFacts a_port() {
    PortFacts facts;
    facts.mode = S_IFCHR | 0660;
    facts.group = "dialout";
    facts.user = "ada";
    facts.own_pid = 1;
    return facts;
}

SerialPort usb_port(const std::string& name, const std::string& product) {
    SerialPort port;
    port.path = name;
    port.product = product;
    return port;
}

TEST(OpenProblem, NamesTheGroupAndTheCommandThatGivePermission) {
    const Problem problem = explain_open_error(path, EACCES, a_port());
    EXPECT_EQ(problem.code, errc::permission_denied);
    EXPECT_EQ(problem.cause, "user ada may not open /dev/ttyUSB0, which belongs to group dialout");
    EXPECT_THAT(problem.hint, HasSubstr("sudo usermod -aG dialout ada"));
    EXPECT_THAT(problem.hint, HasSubstr("log in again"));
}

TEST(OpenProblem, TellsAMemberWhoseLoginDoesNotKnowYetToLogInAgain) {
    PortFacts facts = a_port();
    facts.member = true;
    const Problem problem = explain_open_error(path, EACCES, facts);
    EXPECT_THAT(problem.cause, HasSubstr("this login does not know yet"));
    EXPECT_THAT(problem.hint, HasSubstr("log out and in again"));
    EXPECT_THAT(problem.hint, testing::Not(HasSubstr("usermod")));
}

TEST(OpenProblem, AdvisesNoGroupThatCouldNotOpenThePortEither) {
    PortFacts facts = a_port();
    facts.mode = S_IFCHR | 0600;
    EXPECT_THAT(explain_open_error(path, EACCES, facts).hint, HasSubstr("chmod 660 /dev/ttyUSB0"));
}

TEST(OpenProblem, NeverAdvisesToJoinGroupRoot) {
    PortFacts facts = a_port();
    facts.group = "root";
    EXPECT_THAT(explain_open_error(path, EACCES, facts).hint, testing::Not(HasSubstr("-aG root")));
}

TEST(OpenProblem, TellsDeviceRulesFromFilePermissions) {
    const Problem problem = explain_open_error(path, EPERM, a_port());
    EXPECT_EQ(problem.code, errc::permission_denied);
    EXPECT_THAT(problem.hint, HasSubstr("--device=/dev/ttyUSB0"));
}

TEST(OpenProblem, ListsThePortsThereAreWhenOneIsMissing) {
    PortFacts facts;
    facts.ports = {usb_port("/dev/ttyUSB1", "CP2102"), usb_port("/dev/ttyUSB2", "")};
    const Problem problem = explain_open_error(path, ENOENT, facts);
    EXPECT_EQ(problem.code, errc::port_not_found);
    EXPECT_EQ(problem.cause, "there is no port /dev/ttyUSB0");
    EXPECT_EQ(problem.hint, "the USB serial ports here are /dev/ttyUSB1 (CP2102), /dev/ttyUSB2");
}

TEST(OpenProblem, NamesTheOnlyPortThereIs) {
    PortFacts facts;
    facts.ports = {usb_port("/dev/ttyUSB1", "CP2102")};
    EXPECT_EQ(
        explain_open_error(path, ENOENT, facts).hint,
        "the only USB serial port here is /dev/ttyUSB1 (CP2102)"
    );
}

TEST(OpenProblem, AsksForTheCableWhenThereIsNoPortAtAll) {
    EXPECT_THAT(explain_open_error(path, ENOENT, {}).hint, HasSubstr("plug the adapter in"));
}

TEST(OpenProblem, SaysThatADeviceFileHasNoDevice) {
    EXPECT_THAT(
        explain_open_error(path, ENXIO, a_port()).cause,
        HasSubstr("no device behind /dev/ttyUSB0")
    );
}

TEST(OpenProblem, NamesTheProcessThatHoldsThePort) {
    PortFacts facts = a_port();
    facts.holders = {{1, "sweepcast"}, {812, "screen"}};
    const Problem problem = explain_open_error(path, EWOULDBLOCK, facts);
    EXPECT_EQ(problem.code, errc::port_busy);
    EXPECT_EQ(problem.cause, "/dev/ttyUSB0 is in use by screen (process 812)");
    EXPECT_THAT(problem.hint, HasSubstr("kill 812"));
}

TEST(OpenProblem, NamesACompetitorBeforeAnEmulator) {
    PortFacts facts = a_port();
    facts.holders = {{700, "python3", true}, {812, "screen"}};
    EXPECT_THAT(explain_open_error(path, EBUSY, facts).cause, HasSubstr("screen (process 812)"));
    facts.holders.pop_back();
    EXPECT_THAT(explain_open_error(path, EBUSY, facts).cause, HasSubstr("python3 (process 700)"));
}

TEST(OpenProblem, KnowsHowToStopModemManager) {
    PortFacts facts = a_port();
    facts.holders = {{812, "ModemManager"}};
    EXPECT_THAT(
        explain_open_error(path, EBUSY, facts).hint,
        HasSubstr("systemctl disable --now ModemManager")
    );
}

TEST(OpenProblem, PointsToTheGatewayThatHoldsThePort) {
    PortFacts facts = a_port();
    facts.holders = {{812, "sweepcast"}};
    const Problem problem = explain_open_error(path, EBUSY, facts);
    EXPECT_THAT(problem.hint, HasSubstr("/api/v1/lidars"));
    EXPECT_THAT(problem.hint, HasSubstr("kill 812"));
}

TEST(OpenProblem, SaysThatWeHoldThePortOurselves) {
    PortFacts facts = a_port();
    facts.holders = {{1, "sweepcast"}};
    EXPECT_THAT(explain_open_error(path, EBUSY, facts).cause, HasSubstr("this very process (1)"));
}

TEST(OpenProblem, SaysHowToFindAHolderThatWeMayNotSee) {
    const Problem problem = explain_open_error(path, EBUSY, a_port());
    EXPECT_EQ(problem.cause, "/dev/ttyUSB0 is in use by a process of another user");
    EXPECT_THAT(problem.hint, HasSubstr("sudo fuser -v /dev/ttyUSB0"));
}

TEST(OpenObstacle, IsNoneForAFileThatMayBeOpenedAndToldForAMissingOne) {
    EXPECT_EQ(find_open_obstacle("/dev/null"), 0);
    EXPECT_EQ(find_open_obstacle("/dev/nonexistent"), ENOENT);
}

TEST(OpenProblem, SaysThatNoHardwareAnswers) {
    const Problem problem = explain_open_error("/dev/ttyS3", EIO, a_port());
    EXPECT_EQ(problem.code, errc::io_error);
    EXPECT_THAT(problem.cause, HasSubstr("no working serial hardware answers behind /dev/ttyS3"));
}

TEST(OpenProblem, PassesOnWhatTheSystemSaysOtherwise) {
    const Problem problem = explain_open_error(path, EMFILE, a_port());
    EXPECT_EQ(problem.code, errc::io_error);
    EXPECT_THAT(problem.cause, HasSubstr("Too many open files"));
}

TEST(OpenProblem, NamesTheSpeedThatTheAdapterChoseInstead) {
    const Problem problem = explain_baud(path, 1000000, 921600);
    EXPECT_EQ(problem.code, errc::baud_not_supported);
    EXPECT_EQ(
        problem.cause,
        "the adapter at /dev/ttyUSB0 cannot run at 1000000 baud (it chose 921600)"
    );
}

TEST(OpenProblem, HasAHintForEveryCause) {
    for (const int error : {ENOENT, ENXIO, EACCES, EPERM, EBUSY, ENOTTY, EISDIR, EIO, EMFILE}) {
        EXPECT_FALSE(explain_open_error(path, error, {}).hint.empty()) << error;
        EXPECT_FALSE(explain_open_error(path, error, {}).cause.empty()) << error;
    }
}

TEST(PortFactsOfTheSystem, NameTypeGroupAndUser) {
    const PortFacts facts = gather_port_facts("/");
    ASSERT_TRUE(facts.mode.has_value());
    EXPECT_TRUE(S_ISDIR(*facts.mode));
    EXPECT_FALSE(facts.group.empty());
    EXPECT_FALSE(facts.user.empty());
}

TEST(LinkError, HasAMessageForEveryValue) {
    for (int value = 1; value <= static_cast<int>(errc::io_error); ++value) {
        const error_code ec(value, link_category());
        EXPECT_THAT(ec.message(), testing::Not(HasSubstr("unknown"))) << value;
    }
    EXPECT_EQ(error_code(errc::timed_out).category().name(), std::string("sweepcast.link"));
}

}  // namespace
}  // namespace sweepcast::link
