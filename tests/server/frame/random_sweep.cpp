// Made-up sweeps.
#include "tests/server/frame/random_sweep.hpp"

#include "server/frame/angle_units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace sweepcast::frame {

namespace {

using protocol::Sample;
using Random = std::mt19937_64;

std::uint64_t below(Random& random, std::uint64_t limit) {
    return random() % limit;
}

protocol::SampleTime at(std::int64_t us) {
    return protocol::SampleTime(std::chrono::microseconds(us));
}

std::size_t random_count(Random& random) {
    constexpr std::array<std::size_t, 6> counts{0, 1, 2, 3, 40, 300};
    return counts[below(random, counts.size())];
}

void set_angles(std::vector<Sample>& samples, Random& random) {
    const auto shape = below(random, 4);
    std::uint32_t q6 = static_cast<std::uint32_t>(below(random, q6_per_turn));
    for (auto& sample : samples) {
        switch (shape) {
        case 0:
            sample.angle.raw = static_cast<std::uint16_t>(random());
            break;
        case 1:
            sample.angle = from_q6(static_cast<std::uint32_t>(below(random, q6_per_turn)));
            break;
        case 2:
            sample.angle.raw = random() % 2 == 0 ? 0 : 65535;
            break;
        default:
            sample.angle = from_q6(q6 = (q6 + 50) % q6_per_turn);
            break;
        }
    }
}

void set_distances(std::vector<Sample>& samples, Random& random) {
    const auto shape = below(random, 4);
    for (auto& sample : samples) {
        const auto any = static_cast<std::uint32_t>(random());
        switch (shape) {
        case 0:
            sample.distance.raw = any;
            break;
        case 1:
            sample.distance.raw = any % 3 == 0 ? 0 : 4000 + any % 64;
            break;
        case 2:
            sample.distance.raw = any % 3 == 0 ? 0 : 4000 + any % 64 * 4;
            break;
        default:
            sample.distance.raw =
                any % 2 == 0 ? std::numeric_limits<std::uint32_t>::max() : any / 2 % 2;
            break;
        }
    }
}

void set_qualities(std::vector<Sample>& samples, Random& random) {
    const auto shape = below(random, 3);
    const auto usual = static_cast<std::uint8_t>(random());
    for (auto& sample : samples) {
        const std::uint8_t constant = sample.distance.has_echo() ? usual : std::uint8_t{0};
        sample.quality = shape == 0 ? static_cast<std::uint8_t>(random()) : constant;
    }
    if (shape == 1 && !samples.empty()) {  // constant but for one
        samples[below(random, samples.size())].quality = static_cast<std::uint8_t>(random());
    }
}

void set_flags(std::vector<Sample>& samples, Random& random) {
    const bool wild = random() % 3 == 0;
    for (auto& sample : samples) {
        sample.flag = wild ? static_cast<std::uint8_t>(random()) : std::uint8_t{2};
    }
    if (!samples.empty()) {
        samples.front().flag = 1;
    }
}

void set_times(std::vector<Sample>& samples, Random& random) {
    const auto shape = below(random, 4);
    auto time = static_cast<std::int64_t>(below(random, 1ULL << 50U));
    for (auto& sample : samples) {
        switch (shape) {
        case 0:
            time = static_cast<std::int64_t>(below(random, 1ULL << 42U));
            break;
        case 1:
            time += 500;
            break;
        case 2:
            time += static_cast<std::int64_t>(below(random, 3)) - 1 + 31;
            break;
        default:
            time -= static_cast<std::int64_t>(below(random, 1000));
            break;
        }
        sample.time = at(time);
    }
}

/// Distance in millimetres from the scanner to the wall or pillar in the direction of `angle`
/// (radians).
double distance_in_room(double angle) {
    constexpr double half_width = 3200;
    constexpr double half_depth = 2100;
    const double to_side = half_width / std::max(std::abs(std::cos(angle)), 1e-9);
    const double to_end = half_depth / std::max(std::abs(std::sin(angle)), 1e-9);
    const bool pillar = std::fmod(angle * 7.0, 2 * std::numbers::pi) < 0.35;
    return pillar ? 1250.0 : std::min(to_side, to_end);
}

Sample measure_room(double turn, const ScannerShape& shape, Random& random) {
    std::normal_distribution<double> noise_mm(0, 1.5);
    Sample sample;
    const double mm = distance_in_room(turn * 2 * std::numbers::pi) + noise_mm(random);
    const auto steps = std::lround(mm * 4 / shape.distance_step_q2);
    if (below(random, 100) >= 4) {
        sample.distance.raw = static_cast<std::uint32_t>(steps) * shape.distance_step_q2;
    }
    const auto correction = below(random, 3);
    sample.angle = from_q6(
        (static_cast<std::uint32_t>(turn * q6_per_turn) + static_cast<std::uint32_t>(correction)) %
        q6_per_turn
    );
    if (sample.distance.has_echo()) {
        sample.quality =
            shape.measures_quality ? static_cast<std::uint8_t>(180 + below(random, 24)) : 188;
    }
    sample.flag = 2;
    return sample;
}

}  // namespace

device::CapturedSweep random_sweep(Random& random) {
    device::CapturedSweep captured;
    auto& samples = captured.sweep.samples;
    samples.resize(random_count(random));
    set_angles(samples, random);
    set_distances(samples, random);
    set_qualities(samples, random);
    set_flags(samples, random);
    set_times(samples, random);
    captured.sweep.period = std::chrono::microseconds(below(random, 1ULL << 32U));
    captured.sweep.time_uncertainty = std::chrono::microseconds(below(random, 1ULL << 32U));
    captured.clock_step = std::chrono::nanoseconds(static_cast<std::int64_t>(random()));
    captured.gap = std::chrono::nanoseconds(below(random, 1ULL << 40U));
    captured.sweep.losses = {random(), below(random, 10), 0, below(random, 3)};
    captured.lidar = "A0E1C2D3";
    captured.sequence = random();
    captured.mode = "Sensitivity";
    captured.answer_type = static_cast<protocol::AnswerType>(0x81 + below(random, 6));
    captured.sample_duration = std::chrono::microseconds(below(random, 1000));
    captured.monotonic_to_unix = std::chrono::seconds(1'700'000'000);
    return captured;
}

device::CapturedSweep sweep_of_a_room(const ScannerShape& shape, Random& random) {
    constexpr std::int64_t turn_us = 100'000;
    device::CapturedSweep captured;
    const auto duration = turn_us / static_cast<std::int64_t>(shape.samples);
    for (std::size_t i = 0; i < shape.samples; ++i) {
        const double turn = static_cast<double>(i) / static_cast<double>(shape.samples);
        auto sample = measure_room(turn, shape, random);
        sample.time = at(86'400'000'000 + static_cast<std::int64_t>(i * turn_us / shape.samples));
        captured.sweep.samples.push_back(sample);
    }
    captured.sweep.samples.front().flag = 1;
    captured.sweep.period = std::chrono::microseconds(turn_us);
    captured.lidar = "A0E1C2D3";
    captured.lidar_number = 1;
    captured.sequence = 1;
    captured.mode = "Standard";
    captured.answer_type = shape.answer_type;
    captured.sample_duration = std::chrono::microseconds(duration);
    captured.monotonic_to_unix = std::chrono::seconds(1'700'000'000);
    return captured;
}

}  // namespace sweepcast::frame
