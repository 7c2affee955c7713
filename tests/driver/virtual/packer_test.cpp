// Packers: what every scan mode of every persona streams is the world, read back with the driver's
// own decoders.
#include "driver/protocol/decode.hpp"
#include "driver/protocol/wire.hpp"
#include "tests/driver/virtual/fake_host.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;
using protocol::AnswerType;
using protocol::Command;

// Walls that come and go gently, from 1.5 to 4.5 m, a point every 0.1 degrees: from one to the next
// it is 5.3 mm at most.
std::shared_ptr<const World> wavy_world() {
    std::string text = "angle_deg,distance_mm\n";
    for (int i = 0; i < 3600; ++i) {
        const double angle = i * std::numbers::pi / 1800.0;
        const double distance_mm = 3000.0 + 1500.0 * std::sin(2.0 * angle);
        text += std::to_string(i / 10.0) + "," + std::to_string(distance_mm) + "\n";
    }
    return std::make_shared<const World>(*PolarMap::parse(text, "waves"));
}

struct Stream {
    std::string persona;
    std::uint16_t mode{};
};
void PrintTo(const Stream& stream, std::ostream* out) {
    *out << stream.persona << " mode " << stream.mode;
}

std::vector<Stream> all_streams() {
    std::vector<Stream> streams;
    for (const auto& persona : personas()) {
        for (std::uint16_t id = 0; id < persona.modes.size(); ++id) {
            streams.push_back({std::string(persona.key), id});
        }
    }
    return streams;
}

class EveryStream : public testing::TestWithParam<Stream> {
protected:
    protocol::Decoded scan(std::shared_ptr<const World> world, FakeHost::Duration duration) {
        FakeHost host(GetParam().persona, {}, std::move(world));
        host.switch_on_and_spin_up();
        const auto id = static_cast<std::uint8_t>(GetParam().mode);
        if (type() == AnswerType::normal) {
            host.send(Command::scan);
        } else {
            host.send(Command::express_scan, {id, 0, 0, 0, 0});
        }
        if (persona().motor.control == protocol::MotorControl::self) {
            host.spin_up();
        }
        host.run(duration);
        auto decoder = protocol::Decoder::create(
            type(),
            {.sample_duration = mode().sample_duration(), .baud = persona().baud}
        );
        protocol::Decoded decoded;
        decoder->push(host.measurements(), {}, decoded);
        return decoded;
    }

    static const Persona& persona() { return *find_persona(GetParam().persona); }
    static const ScanMode& mode() { return persona().modes[GetParam().mode]; }
    static AnswerType type() { return mode().answer; }

    /// Of what the answer type can tell in the wavy world: half its step there. The receiver of an
    /// ultra capsule finds the angle by the rounded distance, which may bring the next point; that
    /// of an ultra-dense one averages.
    static double resolution_mm() {
        switch (type()) {
        case AnswerType::normal:
        case AnswerType::hq:
            return 0.125;
        case AnswerType::express:
        case AnswerType::dense:
            return 0.5;
        case AnswerType::ultra:
            return 4.0 + 5.3;
        case AnswerType::ultra_dense:
            return 2.5;
        }
        return 0.0;
    }
};

// The angle in 1/64 degree that a decoder turned into 1/65536 turn, (q6 << 8) / 90, truncated; HQ
// packets tell the latter.
double wire_angle_deg(AnswerType type, protocol::AngleQ14 angle) {
    return type == AnswerType::hq ? angle.degrees() : std::ceil(angle.raw * 90.0 / 256.0) / 64.0;
}

TEST_P(EveryStream, IsTheWorldWithinWhatItsAnswerTypeCanTell) {
    const auto world = wavy_world();
    const auto decoded = scan(world, 600ms);
    const std::chrono::duration<double> sample = mode().sample_duration();
    ASSERT_GT(static_cast<double>(decoded.samples.size()), 0.5 / sample.count());
    EXPECT_TRUE(decoded.events.empty() || decoded.events[0].at_sample == 0);
    EXPECT_LE(decoded.events.size(), 1U);
    for (const auto& measured : decoded.samples) {
        const double angle_deg = wire_angle_deg(type(), measured.angle);
        const auto wall_mm = world->distance_mm(angle_deg, Seconds(0));
        ASSERT_TRUE(wall_mm);
        ASSERT_NEAR(measured.distance.millimetres(), *wall_mm, resolution_mm()) << angle_deg;
        ASSERT_GT(measured.quality, 0);
    }
}

TEST_P(EveryStream, MarksEveryRevolution) {
    const auto decoded = scan(wavy_world(), 1500ms);
    std::size_t marks = 0;
    std::size_t first = 0;
    std::size_t last = 0;
    for (std::size_t i = 0; i < decoded.samples.size(); ++i) {
        if (decoded.samples[i].starts_revolution()) {
            first = marks == 0 ? i : first;
            last = i;
            ++marks;
        }
    }
    ASSERT_GT(marks, 6U);
    const std::chrono::duration<double> sample = mode().sample_duration();
    const double turns = static_cast<double>(marks - 1);
    const double hz = turns / (static_cast<double>(last - first) * sample.count());
    const double nominal_hz = persona().motor.rotation_hz;
    EXPECT_NEAR(hz, nominal_hz, nominal_hz * 0.085);
}

TEST_P(EveryStream, SeesNothingBeyondTheRangeOfItsMode) {
    std::string text = "angle_deg,distance_mm\n";
    for (int i = 0; i < 3600; ++i) {
        text += std::to_string(i / 10.0) + ",41000\n";
    }
    const auto decoded = scan(std::make_shared<const World>(*PolarMap::parse(text, "far")), 500ms);
    ASSERT_FALSE(decoded.samples.empty());
    for (const auto& measured : decoded.samples) {
        ASSERT_FALSE(measured.distance.has_echo());
    }
}

INSTANTIATE_TEST_SUITE_P(
    Modes,
    EveryStream,
    testing::ValuesIn(all_streams()),
    [](const auto& test) {
        auto name = test.param.persona + "_" + std::to_string(test.param.mode);
        std::ranges::replace(name, '-', '_');
        return name;
    }
);

TEST(HqScan, IsAlsoStartedByTheRequestOfThatName) {
    FakeHost host("s3");
    host.switch_on_and_spin_up();
    host.send(Command::hq_scan, Bytes(33, 0));
    host.run(100ms);
    const auto bytes = host.received();
    ASSERT_GT(bytes.size(), 7U + 781U);
    EXPECT_EQ(
        Bytes(bytes.begin(), bytes.begin() + 7),
        (Bytes{0xA5, 0x5A, 0x0D, 0x03, 0x00, 0x40, 0x83})
    );
    FakeHost without("s2");
    without.send(Command::hq_scan, Bytes(33, 0));
    without.run(100ms);
    EXPECT_TRUE(without.received().empty());
}

TEST(UltraDenseScan, TellsTheScannersClock) {
    FakeHost host("c1");
    host.send(Command::express_scan, {1, 0, 0, 0, 0});
    host.run(1200ms);
    const auto bytes = host.measurements();
    ASSERT_GT(bytes.size(), 340U);
    const auto clock = [&bytes](std::size_t packet) {
        const std::span<const std::uint8_t> all(bytes);
        return protocol::load_le32(all.subspan(packet * 170 + 2).first<4>());
    };
    EXPECT_EQ(clock(1) - clock(0), 64U * 200U);
}

TEST(Scan, GoesOnThroughAChangeOfSpeed) {
    struct Case {
        const char* persona;
        Bytes faster;
        double bytes_per_sample;  ///< in its second mode
    };
    for (const auto& [key, faster, bytes_per_sample] :
         {Case{"a3m1", protocol::encode(protocol::set_motor_pwm_request(900)), 84.0 / 32.0},
          Case{"s2", protocol::encode(protocol::motor_rpm_request(840)), 84.0 / 40.0}}) {
        FakeHost host(key);
        host.switch_on_and_spin_up();
        host.send(Command::express_scan, {1, 0, 0, 0, 0});
        host.run(500ms);
        host.received();
        host.events.clear();
        host.send(faster);
        const std::chrono::duration<double> sample = host.persona.modes[1].sample_duration();
        host.run(2s);
        const double expected = 2.0 / sample.count() * bytes_per_sample;
        EXPECT_NEAR(static_cast<double>(host.measurements().size()), expected, 200.0) << key;
        EXPECT_TRUE(host.events.empty()) << key;
    }
}

TEST(Scan, EndsWhenAMotorThatKnowsRpmIsMadeIdle) {
    FakeHost s2("s2");
    s2.switch_on_and_spin_up();
    s2.send(Command::scan);
    s2.events.clear();
    s2.send(protocol::encode(protocol::motor_rpm_request(0)));
    EXPECT_EQ(s2.events, (std::vector{Occurrence::scan_stopped, Occurrence::motor_off}));
    FakeHost c1("c1");
    c1.send(Command::scan);
    c1.events.clear();
    c1.send(protocol::encode(protocol::motor_rpm_request(0)));
    EXPECT_TRUE(c1.events.empty()) << "it does not know the request";
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
