// Addresses to listen on, right and wrong.
#include "server/net/endpoint.hpp"

#include <gtest/gtest.h>

namespace sweepcast::net {
namespace {

TEST(ParseEndpoint, ReadsWhatUsersWrite) {
    for (const auto* text : {"127.0.0.1:8080", "0.0.0.0:0", "[::1]:8080", "[::]:65535"}) {
        const auto endpoint = parse_endpoint(text);
        ASSERT_TRUE(endpoint) << text;
        EXPECT_EQ(to_text(*endpoint), text);
    }
}

TEST(ParseEndpoint, TakesLocalhostForLoopback) {
    EXPECT_EQ(to_text(*parse_endpoint("localhost:1234")), "127.0.0.1:1234");
}

TEST(Callable, AnUnspecifiedAddressIsLoopbackToClientsHere) {
    EXPECT_EQ(to_text(callable(*parse_endpoint("0.0.0.0:8080"))), "127.0.0.1:8080");
    EXPECT_EQ(to_text(callable(*parse_endpoint("[::]:8080"))), "[::1]:8080");
}

TEST(Callable, AnyOtherAddressStays) {
    EXPECT_EQ(to_text(callable(*parse_endpoint("192.0.2.7:8080"))), "192.0.2.7:8080");
}

class BadEndpointTest : public testing::TestWithParam<const char*> {};

TEST_P(BadEndpointTest, IsRefusedWithAnExample) {
    const auto endpoint = parse_endpoint(GetParam());
    ASSERT_FALSE(endpoint);
    EXPECT_NE(endpoint.error().cause.find(GetParam()), std::string::npos);
    EXPECT_NE(endpoint.error().hint.find("127.0.0.1:8080"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Texts,
    BadEndpointTest,
    testing::Values(
        "",
        "8080",
        ":8080",
        "127.0.0.1",
        "127.0.0.1:",
        "127.0.0.1:65536",
        "127.0.0.1:-1",
        "127.0.0.1:80x",
        "::1:8080",
        "[127.0.0.1]:80",
        "example.org:80",
        "[::1:80"
    )
);

}  // namespace
}  // namespace sweepcast::net
