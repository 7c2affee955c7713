// Serial links on real pseudo-terminals.
#include "driver/link/serial_link.hpp"

#include "driver/link/error.hpp"
#include "tests/driver/link/link_fixture.hpp"
#include "tests/driver/link/link_peers.hpp"
#include "tests/driver/link/scratch_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace sweepcast::link {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class SerialLinkTest : public LinkFixture<PtyPeer> {
protected:
    Problem open_badly(const std::string& path) {
        auto opened = open_serial(context_.get_executor(), path, 115200);
        if (opened) {
            throw std::runtime_error(path + " should not have opened");
        }
        return opened.error();
    }
};

TEST_F(SerialLinkTest, ReportsAHangUpToReadsAndWritesAndDtr) {
    peer_.hang_up();
    EXPECT_EQ(read(buffer_, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(write(Bytes{7}, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(link_->set_dtr(true).error(), errc::disconnected);
}

TEST_F(SerialLinkTest, NamesThisProcessWhenThePortIsAlreadyOurs) {
    const Problem problem = open_badly(peer_.path());
    EXPECT_EQ(problem.code, errc::port_busy);
    EXPECT_THAT(problem.cause, HasSubstr(peer_.path() + " is in use"));
    EXPECT_THAT(problem.cause, HasSubstr("(" + std::to_string(::getpid()) + ")"));
}

TEST_F(SerialLinkTest, OpensAgainOnceClosed) {
    link_->close();
    EXPECT_TRUE(open_serial(context_.get_executor(), peer_.path(), 115200).has_value());
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
    const auto opened = open_serial(context_.get_executor(), peer_.path(), 0);
    ASSERT_TRUE(opened.has_error());
    EXPECT_EQ(opened.error().code, errc::baud_not_supported);
}

TEST_F(SerialLinkTest, LeavesNoDescriptorBehindWhenItCannotOpen) {
    const int before = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    ::close(before);
    (void)open_badly("/dev/null");
    (void)open_badly(peer_.path());
    const int after = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    ::close(after);
    EXPECT_EQ(after, before);
}

}  // namespace
}  // namespace sweepcast::link
