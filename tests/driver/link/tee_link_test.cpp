// TeeLink: as good as the link within, and whoever looks on sees all of it in order.
#include "driver/link/tee_link.hpp"

#include "tests/driver/link/link_fixture.hpp"
#include "tests/driver/link/link_peers.hpp"

#include <gtest/gtest.h>

#include <string>

namespace sweepcast::link {
namespace {

using namespace std::chrono_literals;

/// Keeps what it was told: '<', '>' or '=' and the bytes or the speed.
class Witness final : public LinkTap {
public:
    void on_read(std::span<const std::uint8_t> bytes) override { note('<', bytes); }
    void on_write(std::span<const std::uint8_t> bytes) override { note('>', bytes); }
    void on_set_baud(std::uint32_t baud) override { story += "=" + std::to_string(baud) + " "; }

    std::string story;
    Bytes read, written;

private:
    void note(char direction, std::span<const std::uint8_t> bytes) {
        story += direction + std::to_string(bytes.size()) + " ";
        auto& all = direction == '<' ? read : written;
        all.insert(all.end(), bytes.begin(), bytes.end());
    }
};

template <class Peer>
class TeeLinkTest : public LinkFixture<Peer> {
protected:
    TeeLinkTest() { this->link_ = std::make_unique<TeeLink>(std::move(this->link_), witness_); }

    Witness witness_;
};

using AllPeers = testing::Types<PtyPeer, TcpPeer, UdpPeer>;
TYPED_TEST_SUITE(TeeLinkTest, AllPeers);

TYPED_TEST(TeeLinkTest, WhatIsReadAndWrittenIsTold) {
    this->peer_.send(this->every_byte());
    EXPECT_EQ(this->read_exactly(256), this->every_byte());
    EXPECT_EQ(this->witness_.read, this->every_byte());
    ASSERT_TRUE(this->write(this->every_byte(), in(10s)));
    EXPECT_EQ(this->witness_.written, this->every_byte());
    Bytes received;
    while (received.size() < 256) {
        const Bytes more = this->peer_.receive(256);
        received.insert(received.end(), more.begin(), more.end());
    }
    EXPECT_EQ(received, this->every_byte());
}

TYPED_TEST(TeeLinkTest, OnlyWhatWasTakenIsTold) {
    this->peer_.send(Bytes{1, 2, 3});
    ASSERT_EQ(this->read(std::span(this->buffer_).first(2), in(10s)).value(), 2U);
    EXPECT_EQ(this->witness_.read, (Bytes{1, 2}));
}

TYPED_TEST(TeeLinkTest, AReadWithoutBytesIsNotTold) {
    EXPECT_EQ(this->read(this->buffer_, in(5ms)).error(), errc::timed_out);
    EXPECT_TRUE(this->write({}, in(10s)));
    EXPECT_EQ(this->witness_.story, "");
}

TYPED_TEST(TeeLinkTest, AWriteIsToldBeforeItsAnswer) {
    Pending<std::size_t> answer;
    this->start_read(answer, this->buffer_, in(10s));
    ASSERT_TRUE(this->write(Bytes{0xA5, 0x50}, in(10s)));
    EXPECT_EQ(this->peer_.receive(2), (Bytes{0xA5, 0x50}));
    this->peer_.send(Bytes{1, 2, 3});
    ASSERT_EQ(this->finish(answer).value(), 3U);
    EXPECT_EQ(this->witness_.story, ">2 <3 ");
}

TYPED_TEST(TeeLinkTest, InterruptAndCloseReachTheLinkWithin) {
    this->link_->interrupt();
    EXPECT_EQ(this->read(this->buffer_, in(10s)).error(), errc::interrupted);
    this->link_->close();
    EXPECT_EQ(this->read(this->buffer_, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(this->link_->is_network(), TypeParam::is_network);
}

TYPED_TEST(TeeLinkTest, OnlyASpeedThatWasSetIsTold) {
    const auto set = this->link_->set_baud(256'000);
    EXPECT_EQ(static_cast<bool>(set), !TypeParam::is_network);
    EXPECT_EQ(this->witness_.story, set ? "=256000 " : "");
    EXPECT_EQ(this->link_->baud(), set ? 256'000U : 0U);
}

}  // namespace
}  // namespace sweepcast::link
