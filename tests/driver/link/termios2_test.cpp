// Line settings, as set on a pseudo-terminal and read back by the C library.
#include "driver/link/termios2.hpp"

#include "tests/driver/link/pty_pair.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <termios.h>

namespace sweepcast::link {
namespace {

class Slave {
public:
    explicit Slave(const PtyPair& pty)
        : fd_(::open(pty.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC)) {}
    Slave(const Slave&) = delete;
    Slave& operator=(const Slave&) = delete;
    ~Slave() { ::close(fd_); }
    [[nodiscard]] int fd() const { return fd_; }

private:
    int fd_;
};

class BaudRateTest : public testing::TestWithParam<std::uint32_t> {};

TEST_P(BaudRateTest, IsReadBackExactly) {
    const PtyPair pty;
    const Slave slave(pty);
    EXPECT_EQ(set_raw_8n1(slave.fd(), GetParam()).value(), GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    AnyRate,
    BaudRateTest,
    testing::Values(9600, 115200, 256000, 460800, 500000, 1000000, 1500000, 123457)
);

TEST(LineSettings, AreRawEightBitsWithoutFlowControlAndKeepDtrOnClose) {
    const PtyPair pty;
    const Slave slave(pty);
    ASSERT_TRUE(set_raw_8n1(slave.fd(), 256000).has_value());
    termios line{};
    ASSERT_EQ(::tcgetattr(slave.fd(), &line), 0);
    EXPECT_EQ(line.c_iflag, tcflag_t{IGNBRK});
    EXPECT_EQ(line.c_oflag, 0U);
    EXPECT_EQ(line.c_lflag, 0U);
    EXPECT_EQ(line.c_cflag & (CSIZE | CSTOPB | PARENB | CRTSCTS | HUPCL), tcflag_t{CS8});
    EXPECT_EQ(line.c_cflag & (CLOCAL | CREAD), tcflag_t{CLOCAL | CREAD});
    EXPECT_EQ(line.c_cc[VMIN], 1);
    EXPECT_EQ(line.c_cc[VTIME], 0);
}

TEST(LineSettings, RefuseARateOfZeroWhichWouldHangUp) {
    const PtyPair pty;
    const Slave slave(pty);
    EXPECT_EQ(set_raw_8n1(slave.fd(), 0).error().value(), EINVAL);
}

TEST(LineSettings, ReportWhatIsNoTerminal) {
    const int fd = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    EXPECT_EQ(set_raw_8n1(fd, 115200).error().value(), ENOTTY);
    ask_for_low_latency(fd);  // and survive
    ::close(fd);
}

TEST(CloseEnough, IsWithinThreePercent) {
    EXPECT_TRUE(close_enough(256000, 256000));
    EXPECT_TRUE(close_enough(256000, 250000));
    EXPECT_TRUE(close_enough(100000, 103000));
    EXPECT_FALSE(close_enough(100000, 103001));
    EXPECT_TRUE(close_enough(100000, 97000));
    EXPECT_FALSE(close_enough(100000, 96999));
    EXPECT_FALSE(close_enough(256000, 9600));
    EXPECT_TRUE(close_enough(4000000000U, 4000000000U));
}

}  // namespace
}  // namespace sweepcast::link
