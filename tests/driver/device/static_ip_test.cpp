// read_static_ip() and set_static_ip(): what goes over the line, and what is made of the answers.
#include "driver/device/static_ip.hpp"

#include "driver/device/error.hpp"
#include "driver/protocol/error.hpp"
#include "tests/driver/device/fake_scanner.hpp"
#include "tests/driver/device/memory_link.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

#include <vector>

namespace sweepcast::device {
namespace {

namespace asio = boost::asio;
using protocol::Command;
using protocol::ConfType;
using protocol::StaticIp;

constexpr StaticIp factory{{192, 168, 11, 2}, {255, 255, 255, 0}, {192, 168, 11, 1}};
constexpr StaticIp wanted{{10, 0, 0, 7}, {255, 255, 0, 0}, {10, 0, 0, 1}};

class StaticIpTest : public testing::Test {
protected:
    StaticIpTest() {
        line.baud = 0;
        scanner.conf[{ConfType::static_ip, 0}] = protocol::encode_static_ip(factory);
    }

    Result<StaticIp> read() {
        Conversation talk(link);
        auto answer = asio::co_spawn(context, read_static_ip(talk), asio::use_future);
        context.run();
        context.restart();
        return answer.get();
    }

    Result<void> set() {
        Conversation talk(link);
        auto answer = asio::co_spawn(context, set_static_ip(talk, wanted), asio::use_future);
        context.run();
        context.restart();
        return answer.get();
    }

    asio::io_context context;
    Line line{context.get_executor()};
    FakeScanner scanner{line};
    MemoryLink link{line};
};

TEST_F(StaticIpTest, IsAskedForWithTwoZeroBytes) {
    EXPECT_EQ(read().value(), factory);
    const std::vector<std::uint8_t> payload{0xC0, 0xCC, 0x01, 0x00, 0, 0};
    ASSERT_EQ(scanner.requests.size(), 1U);
    EXPECT_EQ(scanner.requests[0], (protocol::Request{Command::get_lidar_conf, payload}));
}

TEST_F(StaticIpTest, ABareEchoMeansThatThereIsNone) {
    scanner.conf.clear();
    EXPECT_EQ(read().error(), protocol::errc::conf_not_supported);
    EXPECT_EQ(scanner.requests.size(), 1U) << "it was asked again";
}

TEST_F(StaticIpTest, SilenceMeansThatThereIsNone) {
    scanner.knows_conf = false;
    EXPECT_EQ(read().error(), protocol::errc::conf_not_supported);
}

TEST_F(StaticIpTest, HalfAnAddressIsNone) {
    scanner.conf[{ConfType::static_ip, 0}].resize(8);
    EXPECT_EQ(read().error(), protocol::errc::length_out_of_range);
}

TEST_F(StaticIpTest, IsReadAsItWasSet) {
    EXPECT_TRUE(set());
    EXPECT_EQ(
        scanner.requests.back(),
        protocol::set_conf_request(ConfType::static_ip, protocol::encode_static_ip(wanted))
    );
    EXPECT_EQ(read().value(), wanted);
}

TEST_F(StaticIpTest, IsReadAsItIsWhereSettingItCameToNothing) {
    scanner.keeps_conf = false;
    EXPECT_TRUE(set());
    EXPECT_EQ(read().value(), factory);
}

TEST_F(StaticIpTest, ARefusalIsToldApartFromSilence) {
    scanner.set_conf_result = 0x80008004;
    EXPECT_EQ(set().error(), protocol::errc::conf_refused);
    scanner.set_conf_result.reset();
    EXPECT_EQ(set().error(), errc::no_answer);
}

}  // namespace
}  // namespace sweepcast::device
