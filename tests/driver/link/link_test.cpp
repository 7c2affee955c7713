// What link.hpp promises, on links of every kind.
#include "driver/link/link.hpp"

#include "tests/driver/link/link_fixture.hpp"
#include "tests/driver/link/link_peers.hpp"

#include <gtest/gtest.h>

namespace sweepcast::link {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;

template <class Peer>
class LinkTest : public LinkFixture<Peer> {};

using AllPeers = testing::Types<PtyPeer, TcpPeer, UdpPeer>;
TYPED_TEST_SUITE(LinkTest, AllPeers);

TYPED_TEST(LinkTest, ReadsEveryByteValueUnchanged) {
    this->peer_.send(this->every_byte());
    EXPECT_EQ(this->read_exactly(256), this->every_byte());
}

TYPED_TEST(LinkTest, WritesEveryByteValueUnchanged) {
    ASSERT_FALSE(this->write(this->every_byte(), in(10s)).has_error());
    Bytes received;
    while (received.size() < 256) {
        const Bytes more = this->peer_.receive(256);
        received.insert(received.end(), more.begin(), more.end());
    }
    EXPECT_EQ(received, this->every_byte());
}

TYPED_TEST(LinkTest, EndsAPendingReadWhenBytesCome) {
    Pending<std::size_t> operation;
    this->start_read(operation, this->buffer_, in(10s));
    EXPECT_FALSE(operation.result.has_value());
    this->peer_.send(Bytes{0xA5, 0x5A});
    EXPECT_EQ(this->finish(operation).value(), 2U);
    EXPECT_EQ(this->buffer_[0], 0xA5);
    EXPECT_EQ(this->buffer_[1], 0x5A);
}

TYPED_TEST(LinkTest, ReadsOneByteAtATimeInOrder) {
    this->peer_.send(Bytes{1, 2, 3});
    Bytes bytes;
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(this->read(std::span(this->buffer_).first(1), in(10s)).value(), 1U);
        bytes.push_back(this->buffer_[0]);
    }
    EXPECT_EQ(bytes, (Bytes{1, 2, 3}));
}

TYPED_TEST(LinkTest, ReadsNothingIntoNothing) {
    EXPECT_EQ(this->read({}, in(10s)).value(), 0U);
}

TYPED_TEST(LinkTest, GivesUpReadingAtTheDeadline) {
    EXPECT_EQ(this->read(this->buffer_, in(2ms)).error(), errc::timed_out);
}

TYPED_TEST(LinkTest, DeliversWhatIsThereAlthoughTheDeadlineHasPassed) {
    this->peer_.send(Bytes{7});
    EXPECT_EQ(this->read(this->buffer_, in(-1ms)).value(), 1U);
    EXPECT_EQ(this->read(this->buffer_, in(-1ms)).error(), errc::timed_out);
}

TYPED_TEST(LinkTest, DeliversBytesThatCameTogetherWithTheDeadline) {
    Pending<std::size_t> operation;
    const auto deadline = in(1ms);
    this->spawn(operation, this->link_->read_some(this->buffer_, deadline));
    this->context_.run_one();  // begins to read, without a look at the clock
    this->peer_.send(Bytes{7});
    while (std::chrono::steady_clock::now() < deadline) {
    }
    EXPECT_EQ(this->finish(operation).value(), 1U);
}

TYPED_TEST(LinkTest, LosesNothingOverManyDeadlines) {
    Bytes received;
    std::uint8_t next = 0;
    while (received.size() < 200) {
        Pending<std::size_t> operation;
        this->start_read(operation, this->buffer_, in(next % 3 == 0 ? 0ms : 1ms));
        this->peer_.send(Bytes{next++});
        if (const auto count = this->finish(operation)) {
            const auto end = this->buffer_.begin() + static_cast<std::ptrdiff_t>(*count);
            received.insert(received.end(), this->buffer_.begin(), end);
        } else {
            ASSERT_EQ(count.error(), errc::timed_out);
        }
    }
    Bytes expected(received.size());
    std::iota(expected.begin(), expected.end(), std::uint8_t{0});
    EXPECT_EQ(received, expected);
}

TYPED_TEST(LinkTest, LosesNothingOverManyInterruptsAndCancellations) {
    Bytes received;
    for (std::uint8_t next = 0; next < 100; ++next) {
        Pending<std::size_t> operation;
        this->start_read(operation, this->buffer_, in(10s));
        this->peer_.send(Bytes{next});
        const bool by_interrupt = next % 2 == 0;
        if (by_interrupt) {
            this->link_->interrupt();
        } else if (!operation.result) {  // else it had what was left by the one before
            operation.cancel.emit(asio::cancellation_type::terminal);
        }
        const auto count = this->finish(operation);
        if (!count) {
            ASSERT_EQ(count.error(), errc::interrupted);
            continue;
        }
        const auto end = this->buffer_.begin() + static_cast<std::ptrdiff_t>(*count);
        received.insert(received.end(), this->buffer_.begin(), end);
        if (by_interrupt) {
            ASSERT_EQ(this->read(this->buffer_, in(10s)).error(), errc::interrupted);
        }
    }
    const Bytes rest = this->read_exactly(100 - received.size());
    received.insert(received.end(), rest.begin(), rest.end());
    Bytes expected(100);
    std::iota(expected.begin(), expected.end(), std::uint8_t{0});
    EXPECT_EQ(received, expected);
}

TYPED_TEST(LinkTest, InterruptsAPendingRead) {
    Pending<std::size_t> operation;
    this->start_read(operation, this->buffer_, in(10s));
    this->link_->interrupt();
    EXPECT_EQ(this->finish(operation).error(), errc::interrupted);
}

TYPED_TEST(LinkTest, InterruptsTheNextReadIfNoneIsPending) {
    this->link_->interrupt();
    this->peer_.send(Bytes{7});
    EXPECT_EQ(this->read(this->buffer_, in(10s)).error(), errc::interrupted);
    EXPECT_EQ(this->read(this->buffer_, in(10s)).value(), 1U) << "an interrupt counts once";
}

TYPED_TEST(LinkTest, InterruptsTheReadAfterOneThatGotItsBytesAtThatMoment) {
    Pending<std::size_t> operation;
    this->peer_.send(Bytes{7});
    this->spawn(operation, this->link_->read_some(this->buffer_, in(10s)));
    // One handler at a time until the read has its bytes in hand but has not resumed.
    this->context_.run_one();
    ASSERT_FALSE(operation.result.has_value());
    this->link_->interrupt();
    EXPECT_EQ(this->finish(operation).value(), 1U);
    EXPECT_EQ(this->read(this->buffer_, in(10s)).error(), errc::interrupted);
}

TYPED_TEST(LinkTest, CancellationOfTheCoroutineEndsAPendingRead) {
    Pending<std::size_t> operation;
    this->start_read(operation, this->buffer_, in(10s));
    operation.cancel.emit(asio::cancellation_type::terminal);
    EXPECT_EQ(this->finish(operation).error(), errc::interrupted);
}

TYPED_TEST(LinkTest, FlushesWhatHasArrived) {
    this->peer_.send(Bytes{1, 2, 3});
    ASSERT_EQ(this->read(std::span(this->buffer_).first(1), in(10s)).value(), 1U);
    this->link_->flush_input();
    this->peer_.send(Bytes{4});
    ASSERT_EQ(this->read(this->buffer_, in(10s)).value(), 1U);
    EXPECT_EQ(this->buffer_[0], 4);
}

TYPED_TEST(LinkTest, FlushingBeforeAnythingCameReturnsAtOnce) {
    this->link_->flush_input();
    this->peer_.send(Bytes{4});
    EXPECT_EQ(this->read(this->buffer_, in(10s)).value(), 1U);
}

TYPED_TEST(LinkTest, ClosingEndsAPendingReadAndRefusesLaterOnes) {
    Pending<std::size_t> operation;
    this->start_read(operation, this->buffer_, in(10s));
    this->link_->close();
    EXPECT_EQ(this->finish(operation).error(), errc::interrupted);
    this->link_->close();
    EXPECT_EQ(this->read(this->buffer_, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(this->write(Bytes{7}, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(this->link_->set_dtr(true).error(), errc::disconnected);
    EXPECT_EQ(this->link_->set_baud(115200).error(), errc::disconnected);
    this->link_->flush_input();
    this->link_->interrupt();
}

TYPED_TEST(LinkTest, HasNoModemLinesHere) {
    EXPECT_EQ(this->link_->set_dtr(true).error(), errc::no_modem_lines);
    EXPECT_EQ(this->link_->set_dtr(false).error(), errc::no_modem_lines);
}

TYPED_TEST(LinkTest, KnowsWhetherItIsANetwork) {
    EXPECT_EQ(this->link_->is_network(), TypeParam::is_network);
    EXPECT_EQ(this->link_->baud(), TypeParam::is_network ? 0U : 115200U);
}

/// Links whose writes wait for the other side, and that notice when it is gone.
template <class Peer>
class StreamLinkTest : public LinkFixture<Peer> {};

using StreamPeers = testing::Types<PtyPeer, TcpPeer>;
TYPED_TEST_SUITE(StreamLinkTest, StreamPeers);

TYPED_TEST(StreamLinkTest, AnInterruptDuringAWriteIsKeptForTheNextRead) {
    const Bytes much(TypeParam::more_than_fits, 0x55);
    Pending<void> writing;
    this->start(writing, this->link_->write_all(much, in(10s)));
    ASSERT_FALSE(writing.result.has_value()) << "nobody reads the other end";
    this->link_->interrupt();
    EXPECT_EQ(this->drain(much.size()), much.size());
    EXPECT_FALSE(this->finish(writing).has_error());
    this->peer_.send(Bytes{7});
    EXPECT_EQ(this->read(this->buffer_, in(10s)).error(), errc::interrupted);
    EXPECT_EQ(this->read(this->buffer_, in(10s)).value(), 1U);
}

TYPED_TEST(StreamLinkTest, GivesUpWritingAtTheDeadline) {
    const Bytes much(TypeParam::more_than_fits, 0x55);
    EXPECT_EQ(this->write(much, in(2ms)).error(), errc::timed_out);
}

TYPED_TEST(StreamLinkTest, KeepsWritingWhileTheDeadlineOfAReadPasses) {
    const Bytes much(TypeParam::more_than_fits, 0x55);
    Pending<void> writing;
    this->start(writing, this->link_->write_all(much, in(10s)));
    ASSERT_FALSE(writing.result.has_value());
    EXPECT_EQ(this->read(this->buffer_, in(1ms)).error(), errc::timed_out);
    ASSERT_FALSE(writing.result.has_value());
    EXPECT_EQ(this->drain(much.size()), much.size());
    EXPECT_FALSE(this->finish(writing).has_error());
}

TYPED_TEST(StreamLinkTest, ReportsAHangUpDuringARead) {
    Pending<std::size_t> operation;
    this->start_read(operation, this->buffer_, in(10s));
    this->peer_.hang_up();
    EXPECT_EQ(this->finish(operation).error(), errc::disconnected);
}

TYPED_TEST(StreamLinkTest, ReportsAHangUpToLaterReads) {
    this->peer_.hang_up();
    EXPECT_EQ(this->read(this->buffer_, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(this->read(this->buffer_, in(10s)).error(), errc::disconnected);
}

}  // namespace
}  // namespace sweepcast::link
