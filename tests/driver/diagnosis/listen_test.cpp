// Listening on a line that never pauses.
#include "driver/diagnosis/listen.hpp"

#include "tests/driver/device/memory_link.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

namespace sweepcast::diagnosis {
namespace {

namespace asio = boost::asio;

TEST(Listen, AsksALineFullOfNoiseFiveTimesAndKeepsLittleOfIt) {
    asio::io_context context;
    device::Line line(context.get_executor());
    const std::vector<std::uint8_t> noise(100'000, 0xFF);
    constexpr std::size_t requests = 1 + 5;  // STOP, then GET_INFO
    std::size_t written = 0;
    line.on_write = [&](auto) {
        line.send(noise);
        if (++written == 10 * requests) {
            line.unplug();
        }
    };
    device::MemoryLink link(line);
    LineLook look;
    const std::array<std::uint32_t, 1> bauds{115200};
    auto done = asio::co_spawn(context, listen(link, bauds, look), asio::use_future);
    context.run();
    EXPECT_TRUE(done.get());
    EXPECT_EQ(written, requests);
    ASSERT_EQ(look.heard.size(), 1U);
    EXPECT_EQ(look.heard[0].kind, HeardKind::noise);
    constexpr std::size_t kept = 16UL * 1024;
    constexpr std::size_t last_read = 4096;
    EXPECT_LE(look.heard[0].bytes, requests * (kept + last_read));
}

}  // namespace
}  // namespace sweepcast::diagnosis
