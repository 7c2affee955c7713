// What is peculiar to links over TCP and UDP.
#include "driver/link/network_link.hpp"

#include "tests/driver/link/link_fixture.hpp"
#include "tests/driver/link/link_peers.hpp"

#include <gtest/gtest.h>

namespace sweepcast::link {
namespace {

using namespace std::chrono_literals;

using TcpLinkTest = LinkFixture<TcpPeer>;
using UdpLinkTest = LinkFixture<UdpPeer>;

TEST_F(TcpLinkTest, ReportsAHangUpToWrites) {
    this->peer_.hang_up();
    // The first goes out and is answered by a reset, which ends the second or one soon after it.
    const Deadline give_up = in(10s);
    Result<void> written = this->write(Bytes{7}, in(10s));
    while (!written.has_error() && std::chrono::steady_clock::now() < give_up) {
        written = this->write(Bytes{7}, in(10s));
    }
    EXPECT_EQ(written.error(), errc::disconnected);
}

TEST_F(TcpLinkTest, HasNoLineSpeedToSet) {
    EXPECT_EQ(link_->set_baud(115200).error(), errc::no_line_speed);
}

TEST_F(UdpLinkTest, HasNoLineSpeedToSet) {
    EXPECT_EQ(link_->set_baud(115200).error(), errc::no_line_speed);
}

TEST_F(UdpLinkTest, ReadsTheLongestDatagramInSmallPieces) {
    Bytes sent(60'000);
    for (std::size_t i = 0; i < sent.size(); ++i) {
        sent[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
    }
    peer_.send(sent);
    peer_.send(Bytes{1, 2});
    EXPECT_EQ(read_exactly(sent.size()), sent);
    EXPECT_EQ(read_exactly(2), (Bytes{1, 2}));
}

TEST_F(UdpLinkTest, ReadsOnPastAnEmptyDatagram) {
    Pending<std::size_t> operation;
    start_read(operation, buffer_, in(10s));
    peer_.send({});
    peer_.send(Bytes{7});
    EXPECT_EQ(finish(operation).value(), 1U);
}

TEST_F(UdpLinkTest, SendsARequestAsOneDatagram) {
    ASSERT_FALSE(write(Bytes{0xA5, 0x50}, in(10s)).has_error());
    ASSERT_FALSE(write(Bytes{0xA5, 0x52}, in(10s)).has_error());
    EXPECT_EQ(peer_.receive(4096), (Bytes{0xA5, 0x50}));
    EXPECT_EQ(peer_.receive(4096), (Bytes{0xA5, 0x52}));
}

TEST_F(UdpLinkTest, SplitsWhatIsLongerThanADatagramMayBe) {
    ASSERT_FALSE(write(Bytes(2500, 0x55), in(10s)).has_error());
    EXPECT_EQ(peer_.receive(4096).size(), 1024U);
    EXPECT_EQ(peer_.receive(4096).size(), 1024U);
    EXPECT_EQ(peer_.receive(4096).size(), 452U);
}

TEST_F(UdpLinkTest, ReportsThatNobodyListens) {
    peer_.hang_up();
    ASSERT_FALSE(write(Bytes{7}, in(10s)).has_error());
    EXPECT_EQ(read(buffer_, in(10s)).error(), errc::disconnected);
}

TEST_F(UdpLinkTest, IgnoresDatagramsOfStrangers) {
    boost::asio::io_context own;
    boost::asio::ip::udp::socket stranger(own, boost::asio::ip::udp::v4());
    ASSERT_FALSE(write(Bytes{7}, in(10s)).has_error());
    const auto link_endpoint = peer_.link_endpoint();
    stranger.send_to(boost::asio::buffer(Bytes{1, 2, 3}), link_endpoint);
    peer_.send(Bytes{4});
    EXPECT_EQ(read_exactly(1), (Bytes{4}));
    EXPECT_EQ(read(buffer_, in(2ms)).error(), errc::timed_out);
}

}  // namespace
}  // namespace sweepcast::link
