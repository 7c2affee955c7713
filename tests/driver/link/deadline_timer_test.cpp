// DeadlineTimer: expiries hit the operation they are meant for, and nothing else.
#include "driver/link/deadline_timer.hpp"

#include <boost/asio/io_context.hpp>
#include <gtest/gtest.h>

#include <optional>

namespace sweepcast::link {
namespace {

using namespace std::chrono_literals;

class DeadlineTimerTest : public testing::Test {
protected:
    static Deadline in(std::chrono::milliseconds delay) {
        return std::chrono::steady_clock::now() + delay;
    }

    boost::asio::io_context context_;
    int expiries_{};
    std::optional<DeadlineTimer> timer_{std::in_place, context_.get_executor(), [this] {
                                            ++expiries_;
                                        }};
};

TEST_F(DeadlineTimerTest, ExpiresOnceWhenTheDeadlinePasses) {
    timer_->start(in(1ms));
    EXPECT_FALSE(timer_->expired());
    context_.run();
    EXPECT_TRUE(timer_->expired());
    EXPECT_EQ(expiries_, 1);
}

TEST_F(DeadlineTimerTest, ExpiresAtOnceForADeadlineInThePast) {
    timer_->start(in(-1ms));
    context_.run();
    EXPECT_EQ(expiries_, 1);
}

TEST_F(DeadlineTimerTest, SparesAnOperationThatHasEnded) {
    timer_->start(in(1ms));
    timer_->finish();
    EXPECT_EQ(context_.run(), 1U);  // the wait ends, and finds nothing to do
    EXPECT_EQ(expiries_, 0);
}

TEST_F(DeadlineTimerTest, SparesALaterOperationWhenTheWaitOfAnEarlierOneEnds) {
    timer_->start(in(1ms));
    timer_->finish();
    timer_->start(in(10min));
    context_.run_one();
    EXPECT_EQ(expiries_, 0);
    EXPECT_FALSE(timer_->expired());
}

TEST_F(DeadlineTimerTest, ExpiresForALaterOperationAlthoughTheWaitBeganForAnEarlierOne) {
    timer_->start(in(1ms));
    timer_->finish();
    timer_->start(in(3ms));
    context_.run();
    EXPECT_EQ(expiries_, 1);
}

TEST_F(DeadlineTimerTest, MovesTheWaitForwardForANearerDeadline) {
    timer_->start(in(10min));
    timer_->finish();
    timer_->start(in(1ms));
    context_.run_one();  // the wait that was ended
    context_.run_one();
    EXPECT_EQ(expiries_, 1);
}

TEST_F(DeadlineTimerTest, ForgetsTheLastExpiryWhenAnOperationBegins) {
    timer_->start(in(-1ms));
    context_.run();
    timer_->finish();
    timer_->start(in(10min));
    EXPECT_FALSE(timer_->expired());
}

TEST_F(DeadlineTimerTest, NeverWaitsWithoutADeadline) {
    timer_->start(Deadline::max());
    EXPECT_EQ(context_.run(), 0U);
}

TEST_F(DeadlineTimerTest, LetsItsContextRunDryWhenStopped) {
    timer_->start(in(10min));
    timer_->finish();
    timer_->stop();
    context_.run();
    EXPECT_EQ(expiries_, 0);
}

TEST_F(DeadlineTimerTest, CallsNobodyOnceItIsGone) {
    timer_->start(in(-1ms));
    timer_.reset();
    context_.run();
    EXPECT_EQ(expiries_, 0);
}

}  // namespace
}  // namespace sweepcast::link
