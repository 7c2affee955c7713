// Playback: a capture comes out of a virtual lidar as it went in, byte for byte and in its time.
#include "driver/virtual/playback.hpp"

#include "driver/capture/capture_writer.hpp"
#include "driver/virtual/error.hpp"
#include "tests/driver/virtual/fake_host.hpp"
#include "tests/driver/virtual/hex.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;
using capture::Direction;
using protocol::Command;
using testing::HasSubstr;

const capture::CaptureHeader header{
    .program = "test",
    .started = "2026-01-31T12:00:00.000Z",
    .model = "S2M1-R2L",
    .model_id = 0x71,
    .serial = "000102030405060708090A0B0C0D0E0F",
    .firmware = "1.07",
    .hardware = 19,
    .mode = "DenseBoost",
    .mode_id = 1,
    .answer_type = protocol::AnswerType::dense,
    .sample_duration = 31'250ns,
    .baud = 1'000'000};

const Bytes descriptor = from_hex("A5 5A 54 00 00 40 85");

// A scan of `blocks` blocks of 100 bytes, one every 10 ms, 2 s after its descriptor. The second
// stream after it is not to be played.
Bytes write_capture(std::ostream& out, int blocks, std::size_t block_size = 100) {
    capture::CaptureWriter writer(out, header);
    EXPECT_TRUE(writer.append(Direction::to_device, 1s, from_hex("A5 82 05 01 00 00 00 00 23")));
    EXPECT_TRUE(writer.append(Direction::from_device, 1s + 1ms, descriptor));
    Random random(3);
    Bytes all;
    for (int i = 0; i < blocks; ++i) {
        Bytes block(block_size);
        for (auto& byte : block) {
            byte = static_cast<std::uint8_t>(random.next());
        }
        EXPECT_TRUE(writer.append(Direction::from_device, 3s + 1ms + i * 10ms, block));
        all.insert(all.end(), block.begin(), block.end());
    }
    EXPECT_TRUE(writer.append(Direction::to_device, 20s, from_hex("A5 20")));
    EXPECT_TRUE(writer.append(Direction::from_device, 20s, from_hex("A5 5A 05 00 00 40 81")));
    EXPECT_TRUE(writer.append(Direction::from_device, 21s, Bytes(50, 0xEE)));
    return all;
}

class PlaybackTest : public testing::Test {
protected:
    void open(int blocks, bool loop = false, std::size_t block_size = 100) {
        auto file = std::make_unique<std::stringstream>();
        captured_ = write_capture(*file, blocks, block_size);
        auto opened = Playback::open(std::move(file), "test", loop);
        ASSERT_TRUE(opened) << opened.error().cause;
        playback_ = std::move(*opened);
        emulator_ = std::make_unique<Emulator>(
            playback_->persona(),
            playback_->serial(),
            Beam(test_world(), playback_->persona().beam, {}),
            now_,
            [this](const Event& event) { events_.push_back(event.what); },
            EmulatorSettings{.playback = playback_.get()}
        );
    }

    void send(Command command, Bytes payload = {}) {
        emulator_->receive(protocol::encode({command, std::move(payload)}), now_);
    }

    Bytes run(FakeHost::Duration duration, FakeHost::Duration step = 1ms) {
        std::vector<Transmitted> transmitted;
        for (const auto end = now_ + duration; now_ < end;) {
            now_ = std::min(now_ + step, end);
            emulator_->advance(now_);
            emulator_->take(now_, transmitted);
        }
        Bytes all;
        for (const auto& part : transmitted) {
            all.insert(all.end(), part.bytes.begin(), part.bytes.end());
        }
        return all;
    }

    Moment now_{1h};
    Bytes captured_;
    std::unique_ptr<Playback> playback_;
    std::vector<Occurrence> events_;
    std::unique_ptr<Emulator> emulator_;
};

TEST_F(PlaybackTest, BringsEveryByteOfTheFirstStreamOnce) {
    open(300);
    send(Command::express_scan, {1, 0, 0, 0, 0});
    auto expected = descriptor;
    expected.insert(expected.end(), captured_.begin(), captured_.end());
    EXPECT_EQ(run(30s, 7ms), expected);
    EXPECT_THAT(
        events_,
        testing::ElementsAre(Occurrence::scan_started, Occurrence::motor_on, Occurrence::played_out)
    );
}

TEST_F(PlaybackTest, KeepsTheTimesOfTheCapture) {
    open(3);
    send(Command::scan);
    now_ += playback_->persona().answer_time;  // the descriptor leaves now
    EXPECT_EQ(run(1'999ms), descriptor);
    EXPECT_EQ(run(1ms).size(), 100U) << "the last byte of a block arrives when it had";
    EXPECT_EQ(run(9ms).size(), 0U);
    EXPECT_EQ(run(1ms).size(), 100U);
    EXPECT_EQ(run(10ms).size(), 100U);
}

TEST_F(PlaybackTest, LosesNothingOfBlocksThatAreFasterThanTheLine) {
    open(20, false, 30'000);  // 3 MB/s on a line of 0.1 MB/s
    send(Command::scan);
    auto played = run(10s, 50ms);
    played.erase(played.begin(), played.begin() + 7);
    EXPECT_EQ(played, captured_);
    EXPECT_EQ(emulator_->overrun_bytes(), 0U);
}

TEST_F(PlaybackTest, GoesRoundWhenLooped) {
    open(10, true);
    send(Command::scan);
    auto played = run(30s);
    played.erase(played.begin(), played.begin() + 7);
    ASSERT_GT(played.size(), captured_.size() * 10);
    for (std::size_t i = 0; i < played.size(); ++i) {
        ASSERT_EQ(played[i], captured_[i % captured_.size()]) << i;
    }
}

TEST_F(PlaybackTest, BeginsAnewWithEveryScan) {
    open(10);
    for (int i = 0; i < 2; ++i) {
        send(Command::scan);
        auto played = run(5s);
        played.erase(played.begin(), played.begin() + 7);
        EXPECT_EQ(played, captured_);
        send(Command::stop);
    }
}

TEST_F(PlaybackTest, IsTheScannerThatWasCaptured) {
    open(1);
    const auto ask = [this](Command command, Bytes payload = {}) {
        send(command, std::move(payload));
        return run(20ms);
    };
    EXPECT_EQ(
        ask(Command::get_info),
        from_hex("A5 5A 14 00 00 00 04 71 07 01 13 00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F")
    );
    EXPECT_EQ(
        ask(Command::get_lidar_conf, {0x7C, 0, 0, 0}),
        from_hex("A5 5A 06 00 00 00 20 7C 00 00 00 01 00")
    );
    EXPECT_EQ(
        ask(Command::get_lidar_conf, {0x75, 0, 0, 0, 1, 0}),
        from_hex("A5 5A 05 00 00 00 20 75 00 00 00 85")
    );
    EXPECT_EQ(
        ask(Command::get_lidar_conf, {0x71, 0, 0, 0, 1, 0}),
        from_hex("A5 5A 08 00 00 00 20 71 00 00 00 40 1F 00 00")
    );
    EXPECT_EQ(emulator_->baud(), 1'000'000U);
}

std::string refusal(const std::string& text) {
    const auto opened = Playback::open(std::make_unique<std::stringstream>(text), "a file", false);
    EXPECT_FALSE(opened);
    EXPECT_EQ(opened.error().code, errc::capture_unusable);
    EXPECT_FALSE(opened.error().hint.empty());
    return opened.error().cause;
}

TEST(Playback, IsNotMadeOfAnythingElse) {
    EXPECT_THAT(refusal(""), HasSubstr("a file"));
    EXPECT_THAT(refusal("angle_deg,distance_mm\n1,2\n"), HasSubstr("a file"));
    std::ostringstream empty;
    const capture::CaptureWriter writer(empty, header);
    EXPECT_THAT(refusal(empty.str()), HasSubstr("no measurements"));
    const auto missing = Playback::load("/no/such/file", false);
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().cause, HasSubstr("No such file"));
}

TEST(Playback, TakesACaptureThatSaysLittle) {
    auto file = std::make_unique<std::stringstream>();
    capture::CaptureHeader sparse;
    sparse.model_id = 0xF3;  // nobody knows it
    sparse.answer_type = protocol::AnswerType::dense;
    capture::CaptureWriter writer(*file, sparse);
    ASSERT_TRUE(writer.append(Direction::from_device, 0ns, descriptor));
    ASSERT_TRUE(writer.append(Direction::from_device, 0ns, Bytes(84, 1)));
    const auto opened = Playback::open(std::move(file), "test", false);
    ASSERT_TRUE(opened) << opened.error().cause;
    EXPECT_EQ((*opened)->persona().model, 0xF3);
    EXPECT_EQ((*opened)->mode().answer, protocol::AnswerType::dense);
    EXPECT_GT((*opened)->persona().baud, 0U);
}

// Nothing holds it up: no time passes in the capture, and a mute scanner's line is never full.
TEST(Playback, ALoopWithoutTimeComesToTheNextMoment) {
    auto file = std::make_unique<std::stringstream>();
    capture::CaptureWriter writer(*file, header);
    ASSERT_TRUE(writer.append(Direction::from_device, 0ns, descriptor));
    ASSERT_TRUE(writer.append(Direction::from_device, 0ns, Bytes(84, 1)));
    const auto playback = Playback::open(std::move(file), "test", true);
    ASSERT_TRUE(playback) << playback.error().cause;
    const Moment now{1h};
    Emulator emulator(
        (*playback)->persona(),
        (*playback)->serial(),
        Beam(test_world(), (*playback)->persona().beam, {}),
        now,
        [](const Event&) {},
        EmulatorSettings{.faults = {.mute = true}, .playback = playback->get()}
    );
    emulator.receive(protocol::encode({Command::scan, {}}), now);
    emulator.advance(now + 1s);
    EXPECT_GT(emulator.next_due(), now + 1s);
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
