// Serial links on real pseudo-terminals.
#include "driver/link/serial_link.hpp"

#include "driver/link/error.hpp"
#include "tests/driver/link/link_fixture.hpp"
#include "tests/driver/link/link_peers.hpp"
#include "tests/driver/link/scratch_directory.hpp"
#include "tests/support/process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace sweepcast::link {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class SerialLinkTest : public LinkFixture<PtyPeer> {
protected:
    Problem open_badly(const std::string& path) {
        auto opened = open_serial_now(context_.get_executor(), path, 115200);
        if (opened) {
            throw std::runtime_error(path + " should not have opened");
        }
        return opened.error();
    }
};

/// How often this process has `file` open.
std::ptrdiff_t descriptors_of(const std::string& file) {
    const std::filesystem::directory_iterator all("/proc/self/fd");
    return std::count_if(begin(all), end(all), [&](const auto& fd) {
        std::error_code closed_meanwhile;
        return std::filesystem::read_symlink(fd.path(), closed_meanwhile) == file;
    });
}

/// Another process that has a port open, and does not ask who else does.
class Holder {
public:
    explicit Holder(const PtyPair& pty)
        : fd_(::open(pty.path().c_str(), O_RDWR | O_NOCTTY))
        , pid_(::fork()) {
        if (pid_ == 0) {
            ::close(pty.fd());  // whoever has both ends plays the device
            for (;;) {
                ::pause();
            }
        }
        ::close(fd_);
    }
    Holder(const Holder&) = delete;
    Holder& operator=(const Holder&) = delete;
    ~Holder() {
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    [[nodiscard]] pid_t pid() const { return pid_; }

private:
    int fd_;
    pid_t pid_;
};

TEST_F(SerialLinkTest, DoesNotOpenAPortThatAnotherProcessHasOpen) {
    const PtyPair held;
    const Holder holder(held);
    const Problem problem = open_badly(held.path());
    EXPECT_EQ(problem.code, errc::port_busy);
    EXPECT_THAT(problem.cause, HasSubstr("(process " + std::to_string(holder.pid()) + ")"));
}

TEST_F(SerialLinkTest, ReportsAHangUpToReadsAndWritesAndDtr) {
    peer_.hang_up();
    EXPECT_EQ(read(buffer_, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(write(Bytes{7}, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(link_->set_dtr(true).error(), errc::disconnected);
}

TEST_F(SerialLinkTest, OpensAPortWhoseEmulatorHasItOpenToo) {
    test::Process emulator(
        {"/usr/bin/python3",
         "-c",
         "import os, signal\n"
         "master, slave = os.openpty()\n"
         "print(os.ttyname(slave), flush=True)\n"
         "signal.pause()\n"}
    );
    const auto port = emulator.wait_for_output("/dev/pts/");
    const auto opened = open_serial_now(context_.get_executor(), port, 115200);
    EXPECT_TRUE(opened) << opened.error().cause;
}

TEST_F(SerialLinkTest, NamesThisProcessWhenThePortIsAlreadyOurs) {
    const Problem problem = open_badly(peer_.path());
    EXPECT_EQ(problem.code, errc::port_busy);
    EXPECT_THAT(problem.cause, HasSubstr(peer_.path() + " is in use"));
    EXPECT_THAT(problem.cause, HasSubstr("(" + std::to_string(::getpid()) + ")"));
}

TEST_F(SerialLinkTest, OpensAgainOnceClosed) {
    link_->close();
    EXPECT_TRUE(open_serial_now(context_.get_executor(), peer_.path(), 115200).has_value());
}

TEST_F(SerialLinkTest, MakesThePortExclusiveUntilItIsClosed) {
    const int other = ::open(peer_.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);  // only root may
    int exclusive = 0;
    if (other >= 0) {
        ASSERT_EQ(::ioctl(other, TIOCGEXCL, &exclusive), 0);
        EXPECT_EQ(exclusive, 1);
        link_->close();
        ASSERT_EQ(::ioctl(other, TIOCGEXCL, &exclusive), 0);
        EXPECT_EQ(exclusive, 0);
        ::close(other);
    } else {
        EXPECT_EQ(errno, EBUSY);
    }
}

TEST_F(SerialLinkTest, SaysThatThereIsNoSuchPort) {
    const Problem problem = open_badly("/dev/ttyUSB_none");
    EXPECT_EQ(problem.code, errc::port_not_found);
    EXPECT_EQ(problem.cause, "there is no port /dev/ttyUSB_none");
    EXPECT_THAT(problem.hint, HasSubstr("USB serial port"));
}

TEST_F(SerialLinkTest, SaysWhatAPathIsThatIsNoSerialPort) {
    const ScratchDirectory scratch;
    const std::string file = scratch.file("notes.txt", "hello").string();
    EXPECT_EQ(open_badly(file).code, errc::not_a_serial_port);
    EXPECT_EQ(open_badly(file).cause, file + " is a regular file, not a serial port");
    EXPECT_EQ(
        open_badly(scratch.root().string()).cause,
        scratch.root().string() + " is a directory, not a serial port"
    );
    EXPECT_EQ(open_badly("/dev/null").cause, "/dev/null is not a serial port");
}

TEST_F(SerialLinkTest, RefusesABaudRateOfZero) {
    link_->close();
    const auto opened = open_serial_now(context_.get_executor(), peer_.path(), 0);
    ASSERT_TRUE(opened.has_error());
    EXPECT_EQ(opened.error().code, errc::baud_not_supported);
}

TEST_F(SerialLinkTest, LeavesNoDescriptorBehindWhenItCannotOpen) {
    const auto before = descriptors_of("/dev/null");
    (void)open_badly("/dev/null");
    EXPECT_EQ(descriptors_of("/dev/null"), before);
    (void)open_badly(peer_.path());
    EXPECT_EQ(descriptors_of(peer_.path()), 1) << "the link's own";
}

}  // namespace
}  // namespace sweepcast::link
