// A capture played on a real pseudo terminal: bit for bit, again and again. playback_test.cpp
// checks the times, with a clock of its own.
#include "driver/capture/capture_writer.hpp"
#include "driver/link/termios2.hpp"
#include "tests/driver/virtual/hex.hpp"
#include "tests/driver/virtual/virtual_lidar_fixture.hpp"

#include <fstream>

namespace sweepcast::virtual_lidar {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using capture::Direction;

constexpr std::uint32_t baud = 460'800;
constexpr int blocks = 40;
constexpr std::size_t block_size = 200;
constexpr auto block_time = 5ms;
constexpr auto spin_up = 100ms;

class PlaybackPortTest : public VirtualLidarTest {
protected:
    /// A scan of 0.3 s, with every byte value in it.
    void create_player(bool loop = false) {
        std::ofstream file(folder_.path("capture"), std::ios::binary);
        capture::CaptureWriter writer(
            file,
            {.model = "C1M1-R2",
             .model_id = 0x41,
             .serial = "000102030405060708090A0B0C0D0E0F",
             .firmware = "1.02",
             .hardware = 18,
             .mode = "UltraDense",
             .mode_id = 1,
             .answer_type = protocol::AnswerType::ultra_dense,
             .sample_duration = 200us,
             .baud = baud}
        );
        ASSERT_TRUE(writer.append(Direction::from_device, 0ns, descriptor_));
        Random random(5);
        for (int i = 0; i < blocks; ++i) {
            Bytes block(block_size);
            for (auto& byte : block) {
                byte = static_cast<std::uint8_t>(random.next());
            }
            ASSERT_TRUE(writer.append(Direction::from_device, spin_up + i * block_time, block));
            captured_.insert(captured_.end(), block.begin(), block.end());
        }
        file.close();
        create({.play = folder_.path("capture"), .loop = loop});
    }

    asio::posix::stream_descriptor open_host() {
        auto port = open_port();
        EXPECT_TRUE(link::set_raw_8n1(port.native_handle(), baud));
        return port;
    }

    const Bytes descriptor_ = from_hex("A5 5A AA 00 00 40 86");
    Bytes captured_;
};

TEST_F(PlaybackPortTest, AHostGetsTheBytesOfTheCapture) {
    ASSERT_NO_FATAL_FAILURE(create_player());
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_host();
        co_await write(port, Command::get_info);
        const auto info = co_await read(port, 27);
        EXPECT_EQ(info[7], 0x41);
        EXPECT_EQ(info[8], 2) << "firmware";
        EXPECT_EQ(info[10], 18) << "hardware";
        co_await write(port, Command::scan);
        EXPECT_EQ(co_await read(port, descriptor_.size()), descriptor_);
        EXPECT_EQ(co_await read(port, captured_.size()), captured_);
        co_await logged("has been played to its end");
    });
}

TEST_F(PlaybackPortTest, EveryScanBeginsAtItsBeginning) {
    ASSERT_NO_FATAL_FAILURE(create_player());
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_host();
        co_await write(port, Command::scan);
        const auto first = co_await read(port, descriptor_.size() + block_size);
        co_await write(port, Command::stop);
        co_await logged("scan stopped");
        port.close();  // with whatever was under way
        co_await logged("closed by the host");
        auto again = open_host();
        co_await write(again, Command::scan);
        EXPECT_EQ(co_await read(again, descriptor_.size()), descriptor_);
        EXPECT_EQ(co_await read(again, captured_.size()), captured_);
    });
}

TEST_F(PlaybackPortTest, ALoopGoesRoundWithoutAGap) {
    ASSERT_NO_FATAL_FAILURE(create_player(true));
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_host();
        co_await write(port, Command::scan);
        EXPECT_EQ(co_await read(port, descriptor_.size()), descriptor_);
        for (int round = 0; round < 3; ++round) {
            EXPECT_EQ(co_await read(port, captured_.size()), captured_) << round;
        }
    });
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
