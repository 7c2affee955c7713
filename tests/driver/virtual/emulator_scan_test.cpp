// Emulator: what its measurements say, read back with the driver's own decoders.
#include "driver/protocol/decode.hpp"
#include "tests/driver/virtual/fake_host.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;
using protocol::AnswerType;
using protocol::Command;

const Bytes express_mode{1, 0, 0, 0, 0};

protocol::Decoded decode(AnswerType type, const Bytes& bytes) {
    auto decoder = protocol::Decoder::create(type, {.sample_duration = 250us, .baud = 115'200});
    protocol::Decoded decoded;
    decoder->push(bytes, {}, decoded);
    return decoded;
}

// A stream of `duration` from a scanner that is up to speed.
protocol::Decoded scan(Command command, FakeHost::Duration duration) {
    FakeHost host;
    host.spin_up();
    host.send(command, command == Command::express_scan ? express_mode : Bytes{});
    host.run(duration);
    const auto type = command == Command::express_scan ? AnswerType::express : AnswerType::normal;
    return decode(type, host.measurements());
}

// The angle in 1/64 degree that a decoder turned into 1/65536 turn: (q6 << 8) / 90, truncated.
double wire_angle_deg(protocol::AngleQ14 angle) {
    return std::ceil(angle.raw * 90.0 / 256.0) / 64.0;
}

std::vector<std::size_t> revolution_starts(const protocol::Decoded& decoded) {
    std::vector<std::size_t> starts;
    for (std::size_t i = 0; i < decoded.samples.size(); ++i) {
        if (decoded.samples[i].starts_revolution()) {
            starts.push_back(i);
        }
    }
    return starts;
}

void expect_regular_revolutions(const protocol::Decoded& decoded, double samples_per_turn) {
    const auto starts = revolution_starts(decoded);
    ASSERT_EQ(starts.size(), 11U) << "two seconds at 5.5 Hz";
    for (std::size_t i = 1; i < starts.size(); ++i) {
        const auto count = static_cast<double>(starts[i] - starts[i - 1]);
        EXPECT_NEAR(count, samples_per_turn, samples_per_turn * 0.006 + 1.0);
    }
}

TEST(NormalScan, MeasuresTheWorldAtTheAnglesItTells) {
    const auto world = test_world();
    const auto decoded = scan(Command::scan, 2s);
    ASSERT_GT(decoded.samples.size(), 3900U);
    for (const auto& sample : decoded.samples) {
        const double angle_deg = wire_angle_deg(sample.angle);
        EXPECT_EQ(sample.distance.millimetres(), world->distance_mm(angle_deg, Seconds(0)));
        EXPECT_GT(sample.quality, 0);
    }
    EXPECT_TRUE(decoded.events.empty());
}

TEST(ExpressScan, MeasuresTheWorldAtTheAnglesItTells) {
    const auto world = test_world();
    const auto decoded = scan(Command::express_scan, 2s);
    ASSERT_GT(decoded.samples.size(), 7800U);
    for (const auto& sample : decoded.samples) {
        const double angle_deg = wire_angle_deg(sample.angle);
        EXPECT_EQ(sample.distance.millimetres(), world->distance_mm(angle_deg, Seconds(0)));
    }
}

TEST(NormalScan, MarksEveryRevolution) {
    expect_regular_revolutions(scan(Command::scan, 2s), 2000.0 / 5.5);
}

TEST(ExpressScan, MarksEveryRevolution) {
    expect_regular_revolutions(scan(Command::express_scan, 2s), 4000.0 / 5.5);
}

TEST(NormalScan, MarksTheFirstSamplePastZero) {
    const auto decoded = scan(Command::scan, 2s);
    for (const auto start : revolution_starts(decoded)) {
        EXPECT_LT(decoded.samples[start].angle.degrees(), 1.0);
        EXPECT_GT(decoded.samples[start - 1].angle.degrees(), 359.0);
    }
}

TEST(NormalScan, TurnsClockwiseByEvenSteps) {
    const auto decoded = scan(Command::scan, 1s);
    for (std::size_t i = 1; i < decoded.samples.size(); ++i) {
        const auto step = static_cast<std::uint16_t>(
            decoded.samples[i].angle.raw - decoded.samples[i - 1].angle.raw
        );
        EXPECT_NEAR(step / 65536.0, 5.5 / 2000.0, 5.5 / 2000.0 * 0.006 + 2.0 / 23040.0);
    }
}

TEST(ExpressScan, RestartsTheAngleReferenceOnceOnly) {
    FakeHost host;
    host.spin_up();
    host.send(Command::express_scan, express_mode);
    host.run(1s);
    const auto bytes = host.measurements();
    ASSERT_GT(bytes.size(), 84U * 100U);
    for (std::size_t i = 0; i + 84 <= bytes.size(); i += 84) {
        EXPECT_EQ((bytes[i + 3] & 0x80) != 0, i == 0) << "capsule " << i / 84;
    }
}

TEST(ExpressScan, OffsetsAnglesByTheGeometryOfTriangulation) {
    // The difference to the evenly spread angle is what a wall at this distance makes it (7.5).
    const auto offset_q3_at = [](const char* distance_mm) {
        std::string text = "angle_deg,distance_mm\n";
        for (int i = 0; i < 360; ++i) {
            text += std::to_string(i) + "," + distance_mm + "\n";
        }
        FakeHost host(std::make_shared<const World>(*PolarMap::parse(text, "ring")));
        host.spin_up();
        host.send(protocol::express_scan_request(1).command, express_mode);
        host.run(100ms);
        const auto bytes = host.measurements();
        return (bytes.at(8) & 15) | ((bytes.at(4) & 3) << 4);
    };
    EXPECT_EQ(offset_q3_at("200"), 9);     // 8 - asin(24.01 / 200) = 1.10 degrees
    EXPECT_EQ(offset_q3_at("1000"), 53);   // 6.62
    EXPECT_EQ(offset_q3_at("11000"), 63);  // 7.87
}

TEST(ExpressScan, ShowsMovementWithinASweep) {
    FakeHost host(std::make_shared<const World>(World::living_room()));
    host.spin_up();
    host.send(Command::express_scan, express_mode);
    host.run(4s);
    const auto decoded = decode(AnswerType::express, host.measurements());
    const auto starts = revolution_starts(decoded);
    ASSERT_GE(starts.size(), 20U);
    int changed = 0;
    const std::size_t turn = starts[1] - starts[0] - 8;
    for (std::size_t i = 0; i < turn; ++i) {
        const double first = decoded.samples[starts[0] + i].distance.millimetres();
        const double later = decoded.samples[starts[15] + i].distance.millimetres();
        changed += std::abs(first - later) > 300.0 ? 1 : 0;
    }
    EXPECT_GE(changed, 10);
    EXPECT_LE(changed, 400) << "the room itself stands still";
}

TEST(ExpressScan, SendsEachSampleWhenItsTimeStampSays) {
    FakeHost host;
    host.send(Command::express_scan, express_mode);
    const auto stable = host.now + host.persona.motor.spin_up;
    Bytes bytes;
    while (bytes.size() < 84U * 2U) {
        host.run(100us, 100us);
        const auto more = host.measurements();
        bytes.insert(bytes.end(), more.begin(), more.end());
    }
    // The vendor's rule counts back from the arrival of a packet (protocol.md 8): the first sample
    // of the second capsule is 32 samples after the first of all.
    const auto transmission = std::chrono::nanoseconds(10s) * 84 / 115'200;
    const auto first = host.now - 250us * 3 / 2 - transmission - 31 * 250us;
    EXPECT_NEAR(
        static_cast<double>((first - stable - 32 * 250us).count()),
        0.0,
        static_cast<double>(Moment::duration(150us).count())
    );
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
