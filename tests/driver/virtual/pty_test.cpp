// Pty: who is at the other end, and what comes through.
#include "driver/virtual/pty.hpp"

#include <boost/asio/io_context.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fcntl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>
#include <vector>

namespace sweepcast::virtual_lidar {
namespace {

class PtyTest : public testing::Test {
protected:
    PtyTest() : pty_(*Pty::open(context_.get_executor(), 256'000)) {}
    ~PtyTest() override { close_host(); }

    void open_host() { host_ = ::open(pty_->address().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK); }
    void close_host() {
        if (host_ >= 0) {
            ::close(host_);
            host_ = -1;
        }
    }
    HostPort::Received read() { return pty_->read_some(buffer_); }

    boost::asio::io_context context_;
    std::unique_ptr<Pty> pty_;
    int host_{-1};
    std::array<std::uint8_t, 256> buffer_{};
};

TEST_F(PtyTest, KnowsWhetherAHostIsThere) {
    EXPECT_FALSE(read().host_present);
    open_host();
    EXPECT_TRUE(read().host_present);
    close_host();
    EXPECT_FALSE(read().host_present);
    open_host();
    EXPECT_TRUE(read().host_present);
}

TEST_F(PtyTest, ReadsWhatAHostWroteBeforeItLeft) {
    open_host();
    ASSERT_EQ(::write(host_, "\xA5\x50", 2), 2);
    close_host();
    EXPECT_EQ(read().bytes, 2U);
    EXPECT_EQ(buffer_[0], 0xA5);
    EXPECT_FALSE(read().host_present);
}

TEST_F(PtyTest, PassesEveryByteAsItIs) {
    open_host();
    std::vector<std::uint8_t> all(256);
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i] = static_cast<std::uint8_t>(i);
    }
    EXPECT_EQ(pty_->write_some(all), all.size());
    std::vector<std::uint8_t> received(300);
    ASSERT_EQ(::read(host_, received.data(), received.size()), 256);
    received.resize(256);
    EXPECT_EQ(received, all);

    ASSERT_EQ(::write(host_, all.data(), all.size()), 256);
    EXPECT_EQ(read().bytes, 256U) << "and nothing of the above as an echo";
    EXPECT_TRUE(std::equal(all.begin(), all.end(), buffer_.begin()));
}

TEST_F(PtyTest, TakesOnlySoMuchForAHostThatDoesNotRead) {
    open_host();
    const std::vector<std::uint8_t> block(4096);
    std::size_t taken = 0;
    std::size_t last = block.size();
    while (last == block.size() && taken < (16U << 20U)) {
        last = pty_->write_some(block);
        taken += last;
    }
    EXPECT_LT(last, block.size());
}

TEST_F(PtyTest, HasNothingLeftForTheNextHostAfterCleaningUp) {
    open_host();
    const std::vector<std::uint8_t> block(100);
    ASSERT_EQ(pty_->write_some(block), block.size());
    termios cooked{};
    ASSERT_EQ(::tcgetattr(host_, &cooked), 0);
    cooked.c_lflag |= static_cast<tcflag_t>(ECHO | ICANON);
    ASSERT_EQ(::tcsetattr(host_, TCSANOW, &cooked), 0);
    close_host();
    pty_->clean_up_after_host(256'000);
    open_host();
    EXPECT_EQ(::read(host_, buffer_.data(), buffer_.size()), -1);
    EXPECT_EQ(errno, EAGAIN);
    termios settings{};
    ASSERT_EQ(::tcgetattr(host_, &settings), 0);
    EXPECT_EQ(settings.c_lflag & static_cast<tcflag_t>(ECHO | ICANON | ISIG), 0U);
    EXPECT_EQ(settings.c_oflag & static_cast<tcflag_t>(OPOST), 0U);
}

TEST_F(PtyTest, IsOpenToItsUserOnly) {
    struct stat status {};
    ASSERT_EQ(::stat(pty_->address().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
