// Changing the speed of a port that is open. In a file of its own because <asm/termbits.h>, which
// shows any speed, clashes with <termios.h>.
#include "tests/driver/link/link_fixture.hpp"
#include "tests/driver/link/link_peers.hpp"

#include <gtest/gtest.h>

#include <asm/termbits.h>
#include <sys/ioctl.h>

namespace sweepcast::link {
namespace {

using namespace std::chrono_literals;

class LineSpeedTest : public LinkFixture<PtyPeer> {
protected:
    /// What the device at the other end would see.
    termios2 line() {
        termios2 settings{};
        if (::ioctl(peer_.fd(), TCGETS2, &settings) != 0) {
            throw std::runtime_error("no line settings to be had");
        }
        return settings;
    }
};

TEST_F(LineSpeedTest, ChangesWhileThePortIsOpen) {
    for (const std::uint32_t baud : {256000U, 460800U, 1000000U, 115200U}) {
        ASSERT_FALSE(link_->set_baud(baud).has_error());
        EXPECT_EQ(link_->baud(), baud);
        EXPECT_EQ(line().c_ospeed, baud);
        EXPECT_EQ(line().c_ispeed, baud);
    }
    ASSERT_FALSE(write(Bytes{0xA5}, in(10s)).has_error());
    EXPECT_EQ(peer_.receive(1), Bytes{0xA5});
    peer_.send(Bytes{7});
    EXPECT_EQ(read(buffer_, in(10s)).value(), 1U);
}

TEST_F(LineSpeedTest, ThrowsAwayWhatCameAtTheOldSpeed) {
    peer_.send(Bytes{1, 2, 3});
    ASSERT_FALSE(link_->set_baud(256000).has_error());
    peer_.send(Bytes{4});
    EXPECT_EQ(read_exactly(1), Bytes{4});
}

TEST_F(LineSpeedTest, ChangesUnderAPendingRead) {
    Pending<std::size_t> operation;
    start_read(operation, buffer_, in(10s));
    ASSERT_FALSE(link_->set_baud(256000).has_error());
    peer_.send(Bytes{7});
    EXPECT_EQ(finish(operation).value(), 1U);
}

TEST_F(LineSpeedTest, IsNeverSetToZeroWhichWouldHangUp) {
    EXPECT_EQ(link_->set_baud(0).error(), errc::baud_not_supported);
    EXPECT_EQ(link_->baud(), 115200U);
    EXPECT_EQ(line().c_ospeed, 115200U);
}

TEST_F(LineSpeedTest, CannotBeSetOnceTheDeviceIsGone) {
    peer_.hang_up();
    EXPECT_EQ(link_->set_baud(256000).error(), errc::disconnected);
}

}  // namespace
}  // namespace sweepcast::link
