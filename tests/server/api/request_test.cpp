// Targets and origins of requests.
#include "server/api/request.hpp"

#include <gtest/gtest.h>

namespace sweepcast::api {
namespace {

TEST(SetTarget, DecodesPathAndQuery) {
    Request request;
    ASSERT_TRUE(set_target(request, "/api/v1/lidars/my%20lidar/scan?format=csv&x=a%26b"));
    EXPECT_EQ(request.path, "/api/v1/lidars/my lidar/scan");
    EXPECT_EQ(request.parameter("format"), "csv");
    EXPECT_EQ(request.parameter("x"), "a&b");
    EXPECT_EQ(request.parameter("y"), "");
}

TEST(SetTarget, RefusesWhatIsNoPath) {
    Request request;
    for (const auto* target : {"", "http://host/", "*", "/%zz", "/a b"}) {
        EXPECT_FALSE(set_target(request, target)) << target;
    }
}

TEST(SameOrigin, ProgramsSendNone) {
    EXPECT_TRUE(same_origin("", "127.0.0.1:8080"));
}

TEST(SameOrigin, OurOwnPageIsWelcome) {
    EXPECT_TRUE(same_origin("http://127.0.0.1:8080", "127.0.0.1:8080"));
    EXPECT_TRUE(same_origin("https://lidar.example", "lidar.example"));
}

TEST(SameOrigin, OtherPagesAreNot) {
    for (const auto* origin :
         {"http://evil.example",
          "http://127.0.0.1:8081",
          "null",
          "http://127.0.0.1:8080.evil.example"}) {
        EXPECT_FALSE(same_origin(origin, "127.0.0.1:8080")) << origin;
    }
}

}  // namespace
}  // namespace sweepcast::api
