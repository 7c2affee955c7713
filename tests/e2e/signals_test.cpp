// Every signal that would end a program ends these tidily: no lidar is left scanning.
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <stdexcept>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): posix_openpt is POSIX, not C++
#include <string>
#include <unistd.h>

namespace sweepcast::test {
namespace {

struct Signal {
    const char* name;
    int number;
};

std::string name_of(const testing::TestParamInfo<Signal>& test) {
    return test.param.name;
}

/// Those whose default action ends a program, but for faults of the program itself.
constexpr std::array stopping{
    Signal{"HUP", SIGHUP},
    Signal{"INT", SIGINT},
    Signal{"QUIT", SIGQUIT},
    Signal{"TERM", SIGTERM},
    Signal{"USR1", SIGUSR1},
    Signal{"USR2", SIGUSR2},
    Signal{"ALRM", SIGALRM},
    Signal{"XCPU", SIGXCPU},
    Signal{"VTALRM", SIGVTALRM},
    Signal{"PROF", SIGPROF},
    Signal{"IO", SIGIO},
    Signal{"PWR", SIGPWR},
    Signal{"STKFLT", SIGSTKFLT},
    Signal{"RTMAX", 64}};

class ServeSignalTest : public testing::TestWithParam<Signal> {};

TEST_P(ServeSignalTest, StopsTheMotorAndExitsWithZero) {
    VirtualLidarProcess lidar;
    GatewayProcess gateway({"--lidar", lidar.port});
    gateway.process.wait_for_log("scanning");
    gateway.process.signal(GetParam().number);
    EXPECT_EQ(gateway.process.wait(), 0);
    lidar.process.wait_for_log("motor off");
}

INSTANTIATE_TEST_SUITE_P(Signals, ServeSignalTest, testing::ValuesIn(stopping), name_of);

class ServeGoesOnTest : public testing::TestWithParam<Signal> {};

TEST_P(ServeGoesOnTest, AfterASignalOfAFailedWrite) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    gateway.process.signal(GetParam().number);
    EXPECT_EQ(http(gateway.http, "GET", "/healthz").status, 200);
    gateway.process.signal(SIGTERM);
    EXPECT_EQ(gateway.process.wait(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Signals,
    ServeGoesOnTest,
    testing::Values(Signal{"PIPE", SIGPIPE}, Signal{"XFSZ", SIGXFSZ}),
    name_of
);

TEST(ServeSignals, AClosingTerminalHangsUpTwiceAndTheMotorIsStoppedAllTheSame) {
    VirtualLidarProcess lidar;
    GatewayProcess gateway({"--lidar", lidar.port});
    gateway.process.wait_for_log("scanning");
    gateway.process.signal(SIGHUP);
    gateway.process.wait_for_log("stopping");
    gateway.process.signal(SIGHUP);
    EXPECT_EQ(gateway.process.wait(), 0);
    lidar.process.wait_for_log("motor off");
}

TEST(ServeSignals, ATerminationAfterAHangUpDoesNotKeepTheMotorFromBeingStopped) {
    VirtualLidarProcess lidar;
    GatewayProcess gateway({"--lidar", lidar.port});
    gateway.process.wait_for_log("scanning");
    gateway.process.signal(SIGHUP);
    gateway.process.wait_for_log("stopping");
    gateway.process.signal(SIGTERM);
    EXPECT_EQ(gateway.process.wait(), 0);
    lidar.process.wait_for_log("motor off");
}

TEST(ServeSignals, AHangUpThatNohupIgnoresStaysIgnored) {
    Process serve(
        {"/bin/sh",
         "-c",
         "trap '' HUP; exec '" + program() +
             "' serve --lidar virtual:a1m8 --http 127.0.0.1:0 --tcp 127.0.0.1:0"}
    );
    const auto page = serve.wait_for_output("page: ");
    const auto address = page.substr(page.find("://") + 3, page.rfind('/') - page.find("://") - 3);
    serve.signal(SIGHUP);
    EXPECT_EQ(http(address, "GET", "/healthz").status, 200);
    serve.signal(SIGTERM);
    EXPECT_EQ(serve.wait(), 0);
}

class OtherCommandsSignalTest : public testing::TestWithParam<Signal> {};

TEST_P(OtherCommandsSignalTest, EndCaptureWithTheMotorOff) {
    const ScratchDirectory scratch;
    VirtualLidarProcess lidar;
    Process capture({program(), "capture", lidar.port, "-o", scratch.file("capture")});
    lidar.process.wait_for_log("scan started");
    capture.signal(GetParam().number);
    EXPECT_EQ(capture.wait(), 0);
    lidar.process.wait_for_log("motor off");
}

TEST_P(OtherCommandsSignalTest, EndDoctorWithTheMotorOff) {
    VirtualLidarProcess lidar;
    Process doctor({program(), "doctor", lidar.port});
    lidar.process.wait_for_log("scan started");
    doctor.signal(GetParam().number);
    EXPECT_EQ(doctor.wait(), 130);
    lidar.process.wait_for_log("motor off");
}

TEST_P(OtherCommandsSignalTest, EndWatch) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    Process watch({program(), "watch", "tcp://" + gateway.tcp, "--json"});
    watch.wait_for_output("\"angle_deg\"");
    watch.signal(GetParam().number);
    EXPECT_EQ(watch.wait(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Signals,
    OtherCommandsSignalTest,
    testing::Values(Signal{"HUP", SIGHUP}, Signal{"QUIT", SIGQUIT}, Signal{"USR1", SIGUSR1}),
    name_of
);

class VirtualSignalTest : public testing::TestWithParam<Signal> {};

TEST_P(VirtualSignalTest, EndsAVirtualLidarAndRemovesItsLink) {
    const ScratchDirectory scratch;
    VirtualLidarProcess lidar({"--link", scratch.file("lidar")});
    lidar.process.signal(GetParam().number);
    EXPECT_EQ(lidar.process.wait(), 0);
    EXPECT_FALSE(std::filesystem::is_symlink(scratch.file("lidar")));
}

INSTANTIATE_TEST_SUITE_P(  // but USR1, which unplugs it
    Signals,
    VirtualSignalTest,
    testing::Values(Signal{"HUP", SIGHUP}, Signal{"QUIT", SIGQUIT}, Signal{"USR2", SIGUSR2}),
    name_of
);

/// A terminal for a program, until it is closed: then writing to it fails.
class Terminal {
public:
    Terminal() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
        std::array<char, 64> name{};
        if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
            ::ptsname_r(master_, name.data(), name.size()) != 0) {
            throw std::runtime_error("there is no pseudo-terminal");
        }
        path_ = name.data();
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;
    ~Terminal() { close(); }

    [[nodiscard]] const std::string& path() const { return path_; }
    void close() {
        if (master_ >= 0) {
            ::close(master_);
            master_ = -1;
        }
    }

private:
    int master_;
    std::string path_;
};

class LostTerminalTest : public testing::TestWithParam<const char*> {};

TEST_P(LostTerminalTest, DoesNotLeaveTheMotorOn) {
    const ScratchDirectory scratch;
    Terminal terminal;
    VirtualLidarProcess lidar;
    Process command(
        {"/bin/sh",
         "-c",
         "cd '" + scratch.file(".") + "'; exec '" + program() + "' " + GetParam() + " '" +
             lidar.port + "' > " + terminal.path() + " 2>&1"}
    );
    lidar.process.wait_for_log("scan started");
    terminal.close();
    command.signal(SIGHUP);
    lidar.process.wait_for_log("scan stopped");
    lidar.process.wait_for_log("motor off");
    command.wait();
}

INSTANTIATE_TEST_SUITE_P(
    Commands,
    LostTerminalTest,
    testing::Values("capture", "doctor"),
    [](const auto& test) { return std::string(test.param); }
);

}  // namespace
}  // namespace sweepcast::test
