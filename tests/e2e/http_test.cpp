// HTTP as it is on the socket: limits, statuses, headers, keep-alive.
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace sweepcast::test {
namespace {

using testing::HasSubstr;

class HttpTest : public testing::Test {
protected:
    static void SetUpTestSuite() {
        gateway = std::make_unique<GatewayProcess>(
            std::vector<std::string>{"--lidar", "virtual:a1m8", "--idle"}
        );
    }
    static void TearDownTestSuite() { gateway.reset(); }

    static std::unique_ptr<GatewayProcess> gateway;
    HttpConnection connection{gateway->http};
};

std::unique_ptr<GatewayProcess> HttpTest::gateway;

TEST_F(HttpTest, ServesThePage) {
    const auto page = connection.ask("GET", "/");
    EXPECT_EQ(page.status, 200);
    EXPECT_EQ(page.header("content-type"), "text/html; charset=utf-8");
    EXPECT_THAT(page.header("content-security-policy"), HasSubstr("default-src 'self'"));
    EXPECT_THAT(page.body, HasSubstr("<canvas"));
}

TEST_F(HttpTest, ServesThePagePackedToThoseWhoCanUnpack) {
    const auto packed = connection.ask("GET", "/app.js", "", {{"Accept-Encoding", "gzip, br"}});
    EXPECT_EQ(packed.header("content-encoding"), "gzip");
    const auto plain = connection.ask("GET", "/app.js");
    EXPECT_EQ(plain.header("content-encoding"), "");
    EXPECT_LT(packed.body.size(), plain.body.size());
}

TEST_F(HttpTest, DoesNotSendAFileTwice) {
    const auto first = connection.ask("GET", "/app.css");
    ASSERT_NE(first.header("etag"), "");
    const auto second =
        connection.ask("GET", "/app.css", "", {{"If-None-Match", first.header("etag")}});
    EXPECT_EQ(second.status, 304);
    EXPECT_EQ(second.body, "");
    EXPECT_EQ(connection.ask("GET", "/healthz").status, 200);
}

TEST_F(HttpTest, AnswersManyRequestsOnOneConnection) {
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(connection.ask("GET", "/healthz").status, 200);
        EXPECT_EQ(connection.ask("GET", "/nothing").status, 404);
    }
}

TEST_F(HttpTest, HeadIsGetWithoutTheBody) {
    const auto get = connection.ask("GET", "/app.css");
    const auto head = connection.ask("HEAD", "/app.css");
    EXPECT_EQ(head.status, 200);
    EXPECT_EQ(head.header("content-length"), std::to_string(get.body.size()));
    EXPECT_EQ(connection.ask("GET", "/healthz").status, 200);
}

struct GetOnly {
    std::string what, path;
};

class GetOnlyTest : public HttpTest, public testing::WithParamInterface<GetOnly> {};

TEST_P(GetOnlyTest, SaysSoToOtherMethods) {
    const auto answer = connection.ask("POST", GetParam().path);
    EXPECT_EQ(answer.status, 405);
    EXPECT_EQ(answer.header("allow"), "GET, HEAD");
    EXPECT_EQ(answer.header("cache-control"), "no-store");
}

INSTANTIATE_TEST_SUITE_P(
    Paths,
    GetOnlyTest,
    testing::Values(
        GetOnly{"page", "/"},
        GetOnly{"script", "/app.js"},
        GetOnly{"stream", "/api/v1/stream"},
        GetOnly{"lidars", "/api/v1/lidars"}
    ),
    [](const auto& path) { return path.param.what; }
);

struct Wrong {
    std::string what, bytes;
    int status;
    std::string code;
};

class WrongRequestTest : public HttpTest, public testing::WithParamInterface<Wrong> {};

TEST_P(WrongRequestTest, GetsTheErrorShape) {
    const auto answer = connection.send_raw(GetParam().bytes);
    EXPECT_EQ(answer.status, GetParam().status);
    EXPECT_EQ(answer.header("content-type"), "application/json");
    EXPECT_THAT(answer.body, HasSubstr("\"error\""));
    EXPECT_THAT(answer.body, HasSubstr("\"code\": \"" + GetParam().code + "\""));
    EXPECT_THAT(answer.body, HasSubstr("\"message\""));
    EXPECT_THAT(answer.body, HasSubstr("\"hint\""));
    EXPECT_EQ(answer.header("cache-control"), "no-store");
}

const std::string post = "POST /api/v1/lidars/virtual-a1m8/start HTTP/1.1\r\nHost: localhost\r\n";

INSTANTIATE_TEST_SUITE_P(
    Requests,
    WrongRequestTest,
    testing::Values(
        Wrong{"garbage", "this is not HTTP\r\n\r\n", 400, "bad_request"},
        Wrong{"path", "GET /nothing HTTP/1.1\r\nHost: localhost\r\n\r\n", 404, "not_found"},
        Wrong{
            "verb",
            "DELETE /api/v1/lidars HTTP/1.1\r\nHost: localhost\r\n\r\n",
            405,
            "method_not_allowed"},
        Wrong{"target", "GET /%zz HTTP/1.1\r\nHost: localhost\r\n\r\n", 400, "bad_target"},
        Wrong{
            "header",
            "GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(20'000, 'x') + "\r\n\r\n",
            431,
            "header_too_large"},
        Wrong{"body", post + "Content-Length: 100000\r\n\r\n", 413, "body_too_large"},
        // The client sends all of it before it reads: the answer must not be lost to a reset.
        Wrong{
            "whole_body",
            post + "Content-Length: 200000\r\n\r\n" + std::string(200'000, 'x'),
            413,
            "body_too_large"},
        Wrong{
            "whole_header",
            "GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(200'000, 'x') + "\r\n\r\n",
            431,
            "header_too_large"},
        Wrong{"json", post + "Content-Length: 5\r\n\r\nhello", 400, "bad_body"},
        Wrong{"origin", post + "Origin: http://evil.example\r\n\r\n", 403, "wrong_origin"},
        Wrong{
            "stream",
            "GET /api/v1/stream HTTP/1.1\r\nHost: localhost\r\n\r\n",
            426,
            "upgrade_required"},
        Wrong{
            "rebound_name",
            "GET / HTTP/1.1\r\nHost: evil.example:8080\r\n\r\n",
            421,
            "unknown_host"},
        Wrong{"no_host", "GET / HTTP/1.1\r\n\r\n", 400, "bad_host"},
        Wrong{
            "query",
            "GET /api/v1/stream?lidar=nobody HTTP/1.1\r\nHost: localhost\r\nConnection: "
            "Upgrade\r\nUpgrade: websocket\r\n"
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
            404,
            "lidar_not_found"},
        Wrong{
            "foreign_page",
            "GET /api/v1/stream HTTP/1.1\r\nHost: localhost\r\nOrigin: "
            "http://evil.example\r\nConnection: Upgrade\r\n"
            "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
            "dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
            403,
            "wrong_origin"}
    ),
    [](const auto& wrong) { return wrong.param.what; }
);

TEST(HttpHost, NamesGivenOnTheCommandLineAreAnswered) {
    GatewayProcess gateway(
        {"--lidar", "virtual:a1m8", "--idle", "--host-name", "robot.example", "--host-name", "r2"}
    );
    HttpConnection connection(gateway.http);
    for (const auto* name : {"robot.example:8080", "R2", "localhost"}) {
        EXPECT_EQ(connection.ask("GET", "/healthz", "", {{"Host", name}}).status, 200) << name;
    }
    EXPECT_EQ(connection.ask("GET", "/healthz", "", {{"Host", "example"}}).status, 421);
}

}  // namespace
}  // namespace sweepcast::test
