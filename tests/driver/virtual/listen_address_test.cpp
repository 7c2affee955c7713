// ListenAddress: as users write it.
#include "driver/virtual/listen_address.hpp"

#include "driver/virtual/error.hpp"

#include <gtest/gtest.h>

namespace sweepcast::virtual_lidar {
namespace {

std::string read(std::string_view text, Connection connection = Connection::serial) {
    const auto address = parse_listen_address(text, connection);
    return address ? to_url(*address) : "refused";
}

TEST(ListenAddress, IsReadAsAUrl) {
    EXPECT_EQ(read("tcp://127.0.0.1:20108"), "tcp://127.0.0.1:20108");
    EXPECT_EQ(read("udp://0.0.0.0:8089"), "udp://0.0.0.0:8089");
    EXPECT_EQ(read("tcp://localhost:0"), "tcp://127.0.0.1:0");
    EXPECT_EQ(read("udp://[::1]:8089"), "udp://[::1]:8089");
}

TEST(ListenAddress, WithoutASchemeIsWhatTheScannerHas) {
    EXPECT_EQ(read("127.0.0.1:1"), "tcp://127.0.0.1:1");
    EXPECT_EQ(read("127.0.0.1:1", Connection::ethernet), "udp://127.0.0.1:1");
    EXPECT_EQ(read("tcp://127.0.0.1:1", Connection::ethernet), "tcp://127.0.0.1:1");
}

TEST(ListenAddress, IsNotReadFromAnythingElse) {
    for (const auto* text :
         {"",
          "tcp://",
          "127.0.0.1",
          "tcp://127.0.0.1",
          "127.0.0.1:",
          "127.0.0.1:65536",
          "127.0.0.1:-1",
          "127.0.0.1:1x",
          "::1:8089",
          "[127.0.0.1]:1",
          "host:1",
          "serial:/dev/x",
          "http://127.0.0.1:80",
          ":80"}) {
        EXPECT_EQ(read(text), "refused") << text;
    }
    EXPECT_EQ(
        parse_listen_address("nonsense", Connection::serial).error().code,
        errc::invalid_option
    );
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
