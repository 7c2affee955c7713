// URLs of streams, right and wrong.
#include "server/client/stream_url.hpp"

#include <gtest/gtest.h>

namespace sweepcast::client {
namespace {

TEST(ParseStreamUrl, ReadsATcpUrl) {
    const auto url = parse_stream_url("tcp://robot:9000");
    ASSERT_TRUE(url);
    EXPECT_FALSE(url->websocket);
    EXPECT_EQ(url->host, "robot");
    EXPECT_EQ(url->port, "9000");
}

TEST(ParseStreamUrl, KnowsTheUsualPorts) {
    EXPECT_EQ(parse_stream_url("tcp://robot")->port, "8081");
    EXPECT_EQ(parse_stream_url("ws://robot")->port, "8080");
}

TEST(ParseStreamUrl, AWebSocketGoesToTheStreamUnlessAPathIsGiven) {
    EXPECT_EQ(parse_stream_url("ws://robot")->target, "/api/v1/stream");
    EXPECT_EQ(parse_stream_url("ws://robot/")->target, "/api/v1/stream");
    EXPECT_EQ(
        parse_stream_url("ws://robot:1/api/v1/stream?compression=none")->target,
        "/api/v1/stream?compression=none"
    );
}

TEST(ParseStreamUrl, AQueryWithoutAPathGoesToTheStream) {
    EXPECT_EQ(parse_stream_url("ws://robot:1?lidar=X")->target, "/api/v1/stream?lidar=X");
    EXPECT_EQ(parse_stream_url("ws://robot:1/?lidar=X")->target, "/api/v1/stream?lidar=X");
}

TEST(ParseStreamUrl, ATcpUrlTakesNoQueryAndTheHintNamesTheOption) {
    const auto url = parse_stream_url("tcp://robot:8081?lidar=X");
    ASSERT_FALSE(url);
    EXPECT_NE(url.error().cause.find("tcp://robot:8081?lidar=X"), std::string::npos);
    EXPECT_NE(url.error().hint.find("--lidar"), std::string::npos);
}

TEST(StreamUrl, AnIpv6AddressHasItsBracketsInUrls) {
    EXPECT_EQ(parse_stream_url("ws://[::1]:8080")->url_host(), "[::1]");
    EXPECT_EQ(parse_stream_url("ws://robot")->url_host(), "robot");
}

TEST(ParseStreamUrl, AnIpv6AddressLosesItsBrackets) {
    EXPECT_EQ(parse_stream_url("tcp://[::1]:8081")->host, "::1");
}

class BadStreamUrlTest : public testing::TestWithParam<const char*> {};

TEST_P(BadStreamUrlTest, IsRefusedWithAnExample) {
    const auto url = parse_stream_url(GetParam());
    ASSERT_FALSE(url);
    EXPECT_NE(url.error().hint.find("tcp://127.0.0.1:8081"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Texts,
    BadStreamUrlTest,
    testing::
        Values("", "robot:8081", "http://robot", "tcp://", "tcp:robot", "ws:///x", "tcp://robot:x")
);

}  // namespace
}  // namespace sweepcast::client
