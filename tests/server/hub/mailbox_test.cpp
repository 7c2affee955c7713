// Mailbox: bounds, order, closing.
#include "server/hub/mailbox.hpp"

#include "tests/server/hub/wire_messages.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <string>
#include <vector>

namespace sweepcast::hub {
namespace {

namespace asio = boost::asio;
using testing::ElementsAre;

class MailboxTest : public testing::Test {
protected:
    /// What the reader gets without waiting.
    std::string take(Mailbox& mailbox) {
        auto taken = asio::co_spawn(context, mailbox.next(), asio::use_future);
        context.restart();
        context.poll();
        return text(taken.get());
    }

    asio::io_context context;
};

TEST_F(MailboxTest, GivesFramesInOrder) {
    Mailbox mailbox(context.get_executor(), {});
    mailbox.push_frame(message("1"));
    mailbox.push_frame(message("2"));
    EXPECT_EQ(take(mailbox), "1");
    EXPECT_EQ(take(mailbox), "2");
    EXPECT_EQ(mailbox.counts().frames_taken, 2U);
}

TEST_F(MailboxTest, DropsTheOldestFrameBeyondItsNumber) {
    Mailbox mailbox(context.get_executor(), {.frames = 2});
    for (const auto* name : {"1", "2", "3", "4"}) {
        mailbox.push_frame(message(name));
    }
    EXPECT_EQ(take(mailbox), "3");
    EXPECT_EQ(take(mailbox), "4");
    EXPECT_EQ(mailbox.counts().frames_dropped, 2U);
}

TEST_F(MailboxTest, DropsTheOldestFramesBeyondItsBytes) {
    const auto big = message(std::string(100, 'x'));
    Mailbox mailbox(
        context.get_executor(),
        {.frames = 100, .frame_bytes = 2 * big->delimited().size()}
    );
    for (int i = 0; i < 10; ++i) {
        mailbox.push_frame(big);
    }
    EXPECT_EQ(mailbox.waiting_bytes(), 2 * big->delimited().size());
    EXPECT_EQ(mailbox.counts().frames_dropped, 8U);
}

TEST_F(MailboxTest, KeepsASingleFrameThatIsBiggerThanItsBytes) {
    Mailbox mailbox(context.get_executor(), {.frames = 8, .frame_bytes = 10});
    mailbox.push_frame(message(std::string(100, 'x')));
    EXPECT_EQ(take(mailbox), std::string(100, 'x'));
}

TEST_F(MailboxTest, ControlMessagesOvertakeFrames) {
    Mailbox mailbox(context.get_executor(), {});
    mailbox.push_frame(message("frame"));
    mailbox.push_control(message("control"));
    EXPECT_EQ(take(mailbox), "control");
    EXPECT_EQ(take(mailbox), "frame");
}

TEST_F(MailboxTest, ClosesWhenTooManyControlMessagesWait) {
    Mailbox mailbox(context.get_executor(), {.controls = 2});
    for (const auto* name : {"1", "2", "3"}) {
        mailbox.push_control(message(name));
    }
    EXPECT_NE(mailbox.close_reason(), "");
    EXPECT_EQ(take(mailbox), "1");
    EXPECT_EQ(take(mailbox), "2");
    EXPECT_EQ(take(mailbox), "(none)");
}

TEST_F(MailboxTest, AfterClosingGivesTheControlMessagesAndThenNothing) {
    Mailbox mailbox(context.get_executor(), {});
    mailbox.push_frame(message("frame"));
    mailbox.push_control(message("farewell"));
    mailbox.close("first reason");
    mailbox.close("second reason");
    mailbox.push_frame(message("late"));
    EXPECT_EQ(take(mailbox), "farewell");
    EXPECT_EQ(take(mailbox), "(none)");
    EXPECT_EQ(mailbox.close_reason(), "first reason");
}

TEST_F(MailboxTest, WakesAReaderThatWaits) {
    Mailbox mailbox(context.get_executor(), {});
    auto taken = asio::co_spawn(context, mailbox.next(), asio::use_future);
    context.poll();
    EXPECT_NE(taken.wait_for(std::chrono::seconds(0)), std::future_status::ready);
    mailbox.push_frame(message("late"));
    context.poll();
    EXPECT_EQ(text(taken.get()), "late");
}

TEST_F(MailboxTest, ClosingWakesAReaderThatWaits) {
    Mailbox mailbox(context.get_executor(), {});
    auto taken = asio::co_spawn(context, mailbox.next(), asio::use_future);
    context.poll();
    mailbox.close("over");
    context.poll();
    EXPECT_EQ(text(taken.get()), "(none)");
}

}  // namespace
}  // namespace sweepcast::hub
