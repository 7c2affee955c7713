// Plays a virtual lidar's measurements over a line that delays.
#include "tests/support/line_model.hpp"

#include "driver/protocol/decode.hpp"
#include "driver/virtual/beam.hpp"
#include "driver/virtual/measurement_stream.hpp"
#include "driver/virtual/motor.hpp"
#include "driver/virtual/random.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

namespace sweepcast::test {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;
using virtual_lidar::Moment;

/// Walls all round at the same distance: what a decoder corrects the angles by is always the same.
std::shared_ptr<const virtual_lidar::World> ring() {
    std::string text = "angle_deg,distance_mm\n";
    for (int degree = 0; degree < 360; ++degree) {
        text += std::to_string(degree) + ",2000\n";
    }
    return std::make_shared<const virtual_lidar::World>(
        *virtual_lidar::PolarMap::parse(text, "ring")
    );
}

double microseconds_of(Moment moment) {
    return static_cast<double>(moment.time_since_epoch().count()) / 1e3;
}

/// The line and the host: bytes go in when the scanner has them, reads come out.
class Line {
public:
    Line(const LineModel& model, std::uint32_t baud, std::vector<LineRead>& reads)
        : model_(model)
        , byte_time_(10'000'000'000LL / baud)
        , reads_(reads) {}

    void send(const std::vector<std::uint8_t>& bytes, Moment ready) {
        busy_until_ = std::max(busy_until_, ready);
        for (const auto byte : bytes) {
            busy_until_ += byte_time_;
            if (model_.poll > 0ns && busy_until_ > polled_ + model_.poll) {
                deliver(polled_ + model_.poll);
                const auto polls = (busy_until_ - polled_ - 1ns) / model_.poll;
                polled_ += polls * model_.poll;
            }
            pending_.push_back(byte);
        }
        if (model_.poll == 0ns) {
            deliver(busy_until_);
        }
    }

    /// What was lost took its time all the same.
    void lose(const std::vector<std::uint8_t>& bytes, Moment ready) {
        busy_until_ =
            std::max(busy_until_, ready) + byte_time_ * static_cast<std::int64_t>(bytes.size());
    }

    virtual_lidar::Random random{17};

private:
    void deliver(Moment at) {
        if (pending_.empty()) {
            return;
        }
        at +=
            nanoseconds(std::llround(random.uniform() * static_cast<double>(model_.jitter.count()))
            );
        seen_ = std::max(seen_, at);  // reads keep their order
        reads_.push_back({std::chrono::floor<std::chrono::microseconds>(seen_), pending_});
        pending_.clear();
    }

    const LineModel& model_;
    nanoseconds byte_time_;
    std::vector<LineRead>& reads_;
    std::vector<std::uint8_t> pending_;
    Moment busy_until_{};
    Moment polled_{1h};
    Moment seen_{};
};

}  // namespace

LineScan::LineScan(
    std::string_view key,
    protocol::AnswerType type,
    const LineModel& model,
    nanoseconds length
) {
    const auto& persona = *virtual_lidar::find_persona(key);
    const auto& mode = *virtual_lidar::find_mode(persona, type);
    sample_duration_ = mode.sample_duration();
    baud_ = persona.baud;
    const Moment switched_on{1h};
    virtual_lidar::Motor motor(persona.motor, switched_on);
    motor.turn_at(persona.motor.rotation_hz, switched_on);
    const auto begin = switched_on + 2 * persona.motor.spin_up + 137us;
    virtual_lidar::Beam beam(ring(), persona.beam, {.noise_mm = 0.0});
    virtual_lidar::MeasurementStream stream(mode, motor, begin);
    Line line(model, baud_, reads_);
    nanoseconds paused{};
    const auto on_host = [&](Moment moment) {
        const auto since = moment - begin;
        const auto drift = static_cast<double>(since.count()) * model.crystal_ppm * 1e-6;
        return moment + paused + nanoseconds(std::llround(drift));
    };
    std::vector<std::uint8_t> undamaged;
    const auto per_packet =
        static_cast<std::size_t>((stream.packet_end() - begin) / sample_duration_);
    auto start = begin;
    while (start < begin + length) {
        if (start - begin > length / 2 && paused == 0ns) {
            paused = model.pause;
        }
        const auto end = stream.packet_end();
        const auto ready = on_host(stream.packet_ready());
        auto bytes = stream.measure(motor, beam, switched_on);
        undamaged.insert(undamaged.end(), bytes.begin(), bytes.end());
        packets_.push_back(
            {microseconds_of(on_host(start)),
             microseconds_of(on_host(end)),
             motor.turns(start),
             motor.turns(end)}
        );
        start = end;
        if (line.random.uniform() < model.damaged) {
            bytes[line.random.next() % bytes.size()] ^= 0x55;
        }
        if (line.random.uniform() < model.lost) {
            line.lose(bytes, ready);
        } else {
            line.send(bytes, ready);
        }
    }
    find_offset(undamaged, type, per_packet);
}

/// How far the angles that a decoder gives are from where the head pointed.
void LineScan::find_offset(
    const std::vector<std::uint8_t>& bytes,
    protocol::AnswerType type,
    std::size_t per_packet
) {
    protocol::Decoded decoded;
    protocol::DecodeSettings settings;
    settings.sample_duration = sample_duration_;
    protocol::Decoder::create(type, settings)->push(bytes, {}, decoded);
    std::vector<double> offsets;
    for (std::size_t i = 0; i < decoded.samples.size(); ++i) {
        const auto& packet = packets_[i / per_packet];
        const auto part = static_cast<double>(i % per_packet) / static_cast<double>(per_packet);
        const auto turns = packet.start_turns + part * (packet.end_turns - packet.start_turns);
        const auto off = decoded.samples[i].angle.raw / 65536.0 - turns;
        offsets.push_back(off - std::round(off));
    }
    std::ranges::nth_element(offsets, offsets.begin() + std::ssize(offsets) / 2);
    offset_turns_ = offsets[offsets.size() / 2];
}

const LineScan::Packet& LineScan::packet_at(double time_us) const {
    const auto after = std::ranges::upper_bound(packets_, time_us, {}, &Packet::start_us);
    return after == packets_.begin() ? packets_.front() : *std::prev(after);
}

double LineScan::true_time_us(const protocol::Sample& sample) const {
    const auto guess_us = static_cast<double>(sample.time.time_since_epoch().count());
    const auto& near = packet_at(guess_us);
    const auto part = (guess_us - near.start_us) / (near.end_us - near.start_us);
    const auto turns_then = near.start_turns + part * (near.end_turns - near.start_turns);
    const auto pointed = sample.angle.raw / 65536.0 - offset_turns_;
    const auto turns = pointed + std::round(turns_then - pointed);
    const auto after = std::ranges::upper_bound(packets_, turns, {}, &Packet::start_turns);
    const auto& packet = after == packets_.begin() ? packets_.front() : *std::prev(after);
    const auto within = (turns - packet.start_turns) / (packet.end_turns - packet.start_turns);
    return packet.start_us + within * (packet.end_us - packet.start_us);
}

}  // namespace sweepcast::test
