#include "driver/device/scan.hpp"

#include "driver/device/error.hpp"
#include "driver/device/motor.hpp"
#include "driver/device/scan_reader.hpp"
#include "driver/link/error.hpp"
#include "driver/protocol/answer_type.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace sweepcast::device {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

constexpr auto descriptor_limit = 2000ms;
/// The device holds samples back until its speed is stable, one to two seconds (protocol.md 13.17).
constexpr auto spin_up_limit = 6s;
/// A line that says nothing for so long, and for three packets, is silent. A network may hold its
/// breath for longer.
constexpr auto shortest_silence = 300ms;
constexpr auto network_silence = 1000ms;
constexpr int packets_of_silence = 3;
/// A silent line is listened to for so much longer: most hiccups end by themselves, and a scan that
/// is begun again costs more.
constexpr auto patience_with_silence = 600ms;
/// The slowest lidars turn twice a second; one whose speed is known misses so many turns.
constexpr auto turn_limit = 3s;
constexpr auto shortest_turn_limit = 1s;
constexpr int turns_missed = 5;

/// Whether a motor told this after that needs time, during which a lidar may hold samples back.
bool is_another_speed(std::uint16_t before, std::uint16_t now) {
    const auto change = std::max(before, now) - std::min(before, now);
    return before == 0 || change * 10 > before;
}

/// How long to wait for the next complete turn after one that took `period`.
Clock::duration next_turn_limit(std::chrono::nanoseconds period) {
    return std::clamp<Clock::duration>(turns_missed * period, shortest_turn_limit, turn_limit);
}

}  // namespace

asio::awaitable<Result<void>> Scan::run() {
    const auto turning = co_await obey_regulator();
    if (!turning) {
        co_return turning;
    }
    const auto descriptor = co_await talk_.open_stream(scan_request(mode_), descriptor_limit);
    if (!descriptor && descriptor.error() == link::errc::timed_out) {
        co_return make_error_code(errc::no_answer);
    }
    if (!descriptor) {
        co_return descriptor.error();
    }
    const auto ended = co_await read_stream(static_cast<protocol::AnswerType>(descriptor->type));
    if (ended.error() == link::errc::timed_out) {
        co_return make_error_code(errc::stream_silent);
    }
    co_return ended;
}

/// Tells the motor what the regulator has it do.
asio::awaitable<Result<void>> Scan::obey_regulator() {
    const auto before = std::exchange(told_, regulator_.setting());
    if (is_another_speed(before, told_)) {
        samples_due_ = Clock::now() + spin_up_limit;
        turn_due_ = samples_due_ + turn_limit;
    }
    co_return co_await run_motor(talk_, control_, told_);
}

/// How long no samples may come, once they have begun to.
Clock::duration Scan::silence_after(protocol::AnswerType type) const {
    const auto samples = static_cast<int>(protocol::samples_per_packet(type));
    return std::max<Clock::duration>(
        packets_of_silence * samples * mode_.sample_duration,
        talk_.link().is_network() ? network_silence : shortest_silence
    );
}

asio::awaitable<Result<void>> Scan::read_stream(protocol::AnswerType type) {
    auto reader = ScanReader::create(type, mode_, talk_.link().baud(), line_);
    if (!reader) {
        co_return reader.error();
    }
    const auto silence_limit = silence_after(type);
    std::vector<protocol::Sweep> finished;
    bool begun = false;
    bool silent = false;
    bool excused = false;  // for bytes without samples, since the last samples
    for (;;) {
        const auto bytes = co_await talk_.read(samples_due_);
        if (!bytes && bytes.error() == link::errc::timed_out && begun && !silent) {
            silent = true;
            samples_due_ = Clock::now() + patience_with_silence;
            observer_.on_silence(false);
            continue;
        }
        if (!bytes) {
            co_return bytes.error();
        }
        const auto now = Clock::now();
        if (now >= samples_due_) {  // it is us who were held up: the turns are on the line
            turn_due_ = std::max(turn_due_, now + turn_limit);
        }
        finished.clear();
        const auto arrival = std::chrono::time_point_cast<std::chrono::microseconds>(now);
        const auto samples = reader->push(*bytes, arrival, finished);
        if (samples > 0) {
            samples_due_ = std::max(samples_due_, now + silence_limit);
            excused = false;
        } else if (now >= samples_due_) {
            // Bytes alone are no scan, but these may be part of a packet, and it is us who are
            // late.
            if (std::exchange(excused, true)) {
                co_return make_error_code(link::errc::timed_out);
            }
            samples_due_ = now + silence_limit;
        }
        if (samples > 0 && !std::exchange(begun, true)) {
            samples_due_ = now + silence_limit;
            turn_due_ = now + turn_limit;  // from here on a stopped motor shows
            observer_.on_first_samples();
        }
        if (samples > 0 && std::exchange(silent, false)) {
            samples_due_ = now + silence_limit;
            observer_.on_silence(true);
        }
        if (!finished.empty()) {
            turn_due_ = std::max(turn_due_, now + next_turn_limit(finished.back().period));
        } else if (now >= turn_due_) {
            co_return make_error_code(errc::not_turning);
        }
        for (auto& sweep : finished) {
            regulator_.observe(sweep.period);
            observer_.on_revolution(std::move(sweep), type);
        }
        if (samples > 0 && !reader->unfinished().samples.empty()) {
            observer_.on_progress(reader->unfinished(), type, arrival);
        }
        if (regulator_.setting() != told_) {
            const auto told = co_await obey_regulator();
            if (!told) {
                co_return told;
            }
        }
    }
}

}  // namespace sweepcast::device
