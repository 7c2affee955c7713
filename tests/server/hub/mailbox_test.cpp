// Mailbox: bounds and order.
#include "server/hub/mailbox.hpp"

#include "tests/server/hub/wire_messages.hpp"

#include <gtest/gtest.h>

#include <string>

namespace sweepcast::hub {
namespace {

TEST(Mailbox, GivesFramesInOrder) {
    Mailbox mailbox({});
    mailbox.push_frame(message("1"));
    mailbox.push_frame(message("2"));
    EXPECT_EQ(text(mailbox.take_frame()), "1");
    EXPECT_EQ(text(mailbox.take_frame()), "2");
    EXPECT_EQ(text(mailbox.take_frame()), "(none)");
}

TEST(Mailbox, DropsTheOldestFrameBeyondItsNumber) {
    Mailbox mailbox({.frames = 2});
    for (const auto* name : {"1", "2", "3", "4"}) {
        mailbox.push_frame(message(name));
    }
    EXPECT_EQ(text(mailbox.take_frame()), "3");
    EXPECT_EQ(text(mailbox.take_frame()), "4");
    EXPECT_EQ(mailbox.frames_dropped(), 2U);
}

TEST(Mailbox, DropsTheOldestFramesBeyondItsBytes) {
    const auto big = message(std::string(100, 'x'));
    Mailbox mailbox({.frames = 100, .frame_bytes = 2 * big->size()});
    for (int i = 0; i < 10; ++i) {
        mailbox.push_frame(big);
    }
    EXPECT_EQ(mailbox.waiting_bytes(), 2 * big->size());
    EXPECT_EQ(mailbox.frames_dropped(), 8U);
}

TEST(Mailbox, KeepsASingleFrameThatIsBiggerThanItsBytes) {
    Mailbox mailbox({.frames = 8, .frame_bytes = 10});
    mailbox.push_frame(message(std::string(100, 'x')));
    EXPECT_EQ(text(mailbox.take_frame()), std::string(100, 'x'));
    EXPECT_EQ(mailbox.waiting_bytes(), 0U);
}

TEST(Mailbox, TakesAndKeepsControlMessagesUpToItsLimit) {
    Mailbox mailbox({.controls = 2});
    EXPECT_TRUE(mailbox.push_control(message("1")));
    EXPECT_TRUE(mailbox.push_control(message("2")));
    EXPECT_FALSE(mailbox.push_control(message("3")));
    EXPECT_EQ(text(mailbox.take_control()), "1");
    EXPECT_EQ(text(mailbox.take_control()), "2");
    EXPECT_EQ(text(mailbox.take_control()), "(none)");
}

TEST(Mailbox, ForgetsItsFramesWithoutCountingThem) {
    Mailbox mailbox({});
    mailbox.push_frame(message("1"));
    mailbox.discard_frames();
    EXPECT_EQ(text(mailbox.take_frame()), "(none)");
    EXPECT_EQ(mailbox.waiting_bytes(), 0U);
    EXPECT_EQ(mailbox.frames_dropped(), 0U);
}

}  // namespace
}  // namespace sweepcast::hub
