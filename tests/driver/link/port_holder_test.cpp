// Finding who has a port open, in a made-up and in the real /proc.
#include "driver/link/port_holder.hpp"

#include "tests/driver/link/pty_pair.hpp"
#include "tests/driver/link/scratch_directory.hpp"
#include "tests/support/process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sweepcast::link {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::IsEmpty;

class PortHolderTest : public testing::Test {
protected:
    void run(const std::string& pid, const std::string& command, const std::filesystem::path& file)
        const {
        scratch_.file("proc/" + pid + "/comm", command + "\n");
        scratch_.link("proc/" + pid + "/fd/0", "/dev/null");
        scratch_.link("proc/" + pid + "/fd/5", file);
    }

    [[nodiscard]] auto holders_of(const std::filesystem::path& port) const {
        return find_port_holders(port.string(), scratch_.root() / "proc");
    }

    ScratchDirectory scratch_;
    std::filesystem::path port_ = scratch_.file("dev/ttyUSB0", "");
};

TEST_F(PortHolderTest, NamesEveryProcessThatHasThePortOpen) {
    run("812", "ModemManager", port_);
    run("99", "minicom", port_);
    run("100", "bash", "/dev/pts/0");
    EXPECT_THAT(
        holders_of(port_),
        ElementsAre(PortHolder{99, "minicom"}, PortHolder{812, "ModemManager"})
    );
}

/// A pseudo-terminal with both ends open in a process of its own, as an emulator of a device has
/// it.
class Emulator {
public:
    Emulator()
        : process_(
              {"/usr/bin/python3",
               "-c",
               "import os, signal\n"
               "master, slave = os.openpty()\n"
               "print(os.ttyname(slave), flush=True)\n"
               "signal.pause()\n"}
          )
        , port_(process_.wait_for_output("/dev/pts/")) {}

    [[nodiscard]] const std::string& port() const { return port_; }
    [[nodiscard]] pid_t pid() const { return process_.pid(); }

private:
    test::Process process_;
    std::string port_;
};

TEST(PortHolders, TellAnEmulatorByItsOtherEnd) {
    const Emulator emulator;
    const auto holders = find_port_holders(emulator.port());
    ASSERT_EQ(holders.size(), 1U);
    EXPECT_EQ(holders[0].pid, emulator.pid());
    EXPECT_TRUE(holders[0].is_emulator);
}

TEST(PortCompetitors, AreNoEmulators) {
    const Emulator emulator;
    EXPECT_THAT(find_port_competitors(emulator.port()), IsEmpty());
}

TEST(PortCompetitors, AreThoseWithTheMasterOfAnotherTerminal) {
    const Emulator emulator;
    const PtyPair ours;
    const int slave = ::open(emulator.port().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    EXPECT_THAT(
        find_port_competitors(emulator.port()),
        ElementsAre(Field(&PortHolder::pid, ::getpid()))
    );
    ::close(slave);
}

TEST_F(PortHolderTest, FollowsTheLinksOfUdev) {
    run("812", "ModemManager", port_);
    scratch_.link("dev/serial/by-id/usb-lidar", "../../ttyUSB0");
    EXPECT_THAT(
        holders_of(scratch_.root() / "dev/serial/by-id/usb-lidar"),
        ElementsAre(PortHolder{812, "ModemManager"})
    );
}

TEST_F(PortHolderTest, PassesOverWhatIsNoProcess) {
    run("self", "sweepcast", port_);
    run("0", "nobody", port_);
    run("12x", "nobody", port_);
    run("99999999999999999999", "nobody", port_);
    EXPECT_THAT(holders_of(port_), IsEmpty());
}

TEST_F(PortHolderTest, MakesTheNameOfACommandPrintable) {
    run("7", "evil\x1b[2J", port_);
    EXPECT_THAT(holders_of(port_), ElementsAre(PortHolder{7, "evil\\u001b[2J"}));
}

TEST_F(PortHolderTest, FindsNobodyForAPortThatDoesNotExist) {
    EXPECT_THAT(holders_of(scratch_.root() / "dev/ttyUSB9"), IsEmpty());
}

TEST(PortHolders, IncludeThisProcess) {
    const PtyPair pty;
    const int slave = ::open(pty.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    EXPECT_THAT(find_port_holders(pty.path()), Contains(Field(&PortHolder::pid, ::getpid())));
    ::close(slave);
}

}  // namespace
}  // namespace sweepcast::link
