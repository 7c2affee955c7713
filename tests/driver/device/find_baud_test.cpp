// Finding the line speed of a lidar, and talking it into another.
#include "driver/device/find_baud.hpp"

#include "driver/device/error.hpp"
#include "driver/link/error.hpp"
#include "tests/driver/device/fake_scanner.hpp"
#include "tests/driver/device/memory_link.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sweepcast::device {
namespace {

namespace asio = boost::asio;
using testing::Contains;
using testing::ElementsAre;

TEST(BaudsToTryTest, BeginWithTheHintsAndHaveEachOnce) {
    const std::vector<std::uint32_t> hints{460800, 0, 230400, 460800};
    EXPECT_THAT(bauds_to_try(hints), ElementsAre(460800, 230400, 115200, 256000, 1000000));
    EXPECT_THAT(bauds_to_try({}), ElementsAre(115200, 256000, 460800, 1000000));
}

class FindBaudTest : public testing::Test {
protected:
    template <class T>
    T run(asio::awaitable<T> task) {
        auto done = asio::co_spawn(context, std::move(task), asio::use_future);
        context.run();
        context.restart();
        return done.get();
    }

    asio::io_context context;
    Line line{context.get_executor()};
    FakeScanner scanner{line};
    MemoryLink link{line};
    Conversation talk{link};
};

class EachSpeed : public FindBaudTest, public testing::WithParamInterface<std::uint32_t> {};

TEST_P(EachSpeed, IsFound) {
    scanner.baud = GetParam();
    const auto found = run(find_baud(talk, usual_bauds));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->baud, GetParam());
    EXPECT_EQ(found->info, scanner.info);
    EXPECT_EQ(line.baud, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Usual, EachSpeed, testing::ValuesIn(usual_bauds));

TEST_F(FindBaudTest, NothingAnswersWhereThereIsNoLidar) {
    scanner.answers = false;
    EXPECT_EQ(run(find_baud(talk, usual_bauds)).error(), errc::no_answer);
}

TEST_F(FindBaudTest, APulledCableIsNoWrongSpeed) {
    line.unplugged = true;
    EXPECT_EQ(run(find_baud(talk, usual_bauds)).error(), link::errc::disconnected);
}

TEST_F(FindBaudTest, ASpeedThatTheAdapterCannotRunAtIsPassedOver) {
    scanner.baud = 1000000;
    line.refused_bauds = {256000, 460800};
    const auto found = run(find_baud(talk, usual_bauds));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->baud, 1000000U);
}

TEST_F(FindBaudTest, SaysSoIfTheAdapterCanRunAtNoneOfTheSpeeds) {
    line.refused_bauds.assign(usual_bauds.begin(), usual_bauds.end());
    const auto found = run(find_baud(talk, usual_bauds));
    EXPECT_EQ(found.error(), link::errc::baud_not_supported);
}

TEST_F(FindBaudTest, NegotiatesAnotherSpeedAndConfirmsIt) {
    scanner.negotiates = true;
    EXPECT_TRUE(run(negotiate_baud(talk, 256000)));
    EXPECT_EQ(line.baud, 256000U);
    EXPECT_THAT(scanner.requests, Contains(protocol::confirm_baud_request(256000)));
}

TEST_F(FindBaudTest, ALidarThatDoesNotNegotiateKeepsItsSpeed) {
    EXPECT_EQ(run(negotiate_baud(talk, 256000)).error(), errc::baud_refused);
    EXPECT_EQ(line.baud, 115200U);
    EXPECT_TRUE(run(find_baud(talk, usual_bauds)));
}

}  // namespace
}  // namespace sweepcast::device
