#include "driver/device/scan.hpp"

#include "driver/device/error.hpp"
#include "driver/device/motor.hpp"
#include "driver/device/scan_reader.hpp"
#include "driver/link/error.hpp"

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
/// Samples come every few milliseconds once they do.
constexpr auto silence_limit = 1000ms;
/// The slowest lidars turn twice a second.
constexpr auto turn_limit = 3s;

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
    told_ = regulator_.setting();
    samples_due_ = Clock::now() + spin_up_limit;
    turn_due_ = samples_due_ + turn_limit;
    co_return co_await run_motor(talk_, control_, told_);
}

asio::awaitable<Result<void>> Scan::read_stream(protocol::AnswerType type) {
    auto reader = ScanReader::create(type, mode_, talk_.link().baud(), line_);
    if (!reader) {
        co_return reader.error();
    }
    std::vector<protocol::Sweep> finished;
    bool begun = false;
    for (;;) {
        const auto bytes = co_await talk_.read(samples_due_);
        if (!bytes) {
            co_return bytes.error();
        }
        const auto now = Clock::now();
        finished.clear();
        const auto arrival = std::chrono::time_point_cast<std::chrono::microseconds>(now);
        const auto samples = reader->push(*bytes, arrival, finished);
        if (samples > 0) {
            samples_due_ = std::max(samples_due_, now + silence_limit);
        } else if (now >= samples_due_) {  // bytes alone are no scan
            co_return make_error_code(link::errc::timed_out);
        }
        if (samples > 0 && !std::exchange(begun, true)) {
            samples_due_ = now + silence_limit;
            turn_due_ = now + turn_limit;
            observer_.on_first_samples();
        }
        if (!finished.empty()) {
            turn_due_ = std::max(turn_due_, now + turn_limit);
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
