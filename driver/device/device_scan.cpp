// The scan in a lidar's life: how it begins, what it brings, how it is begun again when it stalls.
#include "driver/device/advice.hpp"
#include "driver/device/device.hpp"
#include "driver/device/error.hpp"
#include "driver/device/motor.hpp"
#include "driver/link/error.hpp"
#include "driver/protocol/answer_type.hpp"

#include <utility>

namespace sweepcast::device {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;

namespace {

/// Whether a scan that ended so may be begun again on the same connection.
bool is_stall(const error_code& code) {
    return code == errc::no_answer || code == errc::stream_silent || code == errc::not_turning;
}

}  // namespace

asio::awaitable<Result<void>> Device::scan(Conversation& talk) {
    const auto* mode = wanted_mode();
    if (mode == nullptr) {
        mode = best_mode(state_.modes);
    }
    if (mode == nullptr) {
        co_return make_error_code(errc::unknown_mode);
    }
    stamps_.begin_scan(*mode);
    state_.mode = mode->name;
    regulator_.want(wanted_.speed_hz);
    state_.rotation = regulator_.rotation();
    line_watch_.restart();
    happened(Event::start);
    Scan scan(talk, stamps_.mode(), motor_.control, regulator_, state_.line, *this);
    const auto ended = co_await scan.run();
    regulator_.stopped();
    state_.rotation = regulator_.rotation();
    state_.line.warning.clear();
    if (is_stall(ended.error())) {
        co_return co_await restart_stalled(talk, ended.error());
    }
    if (ended.error() != link::errc::interrupted) {
        co_return ended;
    }
    happened(Event::stop);
    const auto silent = co_await talk.silence();
    if (!silent && silent.error() != link::errc::interrupted) {
        co_return silent;
    }
    co_return ended;
}

/// Finds out whether a lidar whose scan does not go on is there and well. Success: the scan may be
/// begun again, or whatever its health asks for. Errors: `why` if that has been tried; those of the
/// link; errc::no_answer.
asio::awaitable<Result<void>> Device::restart_stalled(Conversation& talk, error_code why) {
    const auto problem = advice(why);
    tell_failure(problem, "starting the scan again");
    happened(Event::stall, problem);
    const auto silent = co_await talk.silence();
    if (!silent && silent.error() != link::errc::interrupted) {
        co_return silent;
    }
    const auto health = co_await ask_health(talk);
    if (!health) {
        co_return health.error();
    }
    state_.health = *health;
    const bool is_well = health->status != protocol::HealthStatus::error;
    if (is_well && ++restarts_ > supervisor_.policy().restarts) {
        restarts_ = 0;
        co_return why;
    }
    co_return Result<void>{};
}

void Device::on_first_samples() {
    happened(Event::samples, mode_problem());
}

void Device::on_silence(bool over) {
    if (over) {
        happened(Event::samples, mode_problem());
    } else {
        happened(Event::stall, advice(errc::stream_silent));
    }
}

void Device::on_revolution(protocol::Sweep sweep, protocol::AnswerType type) {
    restarts_ = 0;
    line_watch_.take(state_.line, protocol::samples_per_packet(type), Clock::now());
    report_scan();
    observer_.on_sweep(stamps_.stamp(std::move(sweep), type));
}

void Device::on_progress(
    const protocol::UnfinishedSweep& sweep,
    protocol::AnswerType type,
    protocol::SampleTime arrival
) {
    observer_.on_progress(stamps_.stamp(sweep, type, arrival));
}

/// Tells the speed and the state of the line: at once when the speed is reached or lost or a
/// warning comes or goes, else now and then.
void Device::report_scan() {
    const bool was_settled = std::exchange(state_.rotation, regulator_.rotation()).settled;
    const bool speed_news = tell_warning(told_warning_, state_.rotation.warning);
    state_.line.warning = line_watch_.warning();
    const bool line_news = tell_warning(told_line_warning_, state_.line.warning);
    const bool due = Clock::now() - told_at_ >= options_.report_interval;
    if (speed_news || line_news || state_.rotation.settled != was_settled || due) {
        tell_state();
    }
}

/// Logs a warning that is another than the one told before. Returns whether it is another one.
bool Device::tell_warning(std::string& told, const std::string& warning) {
    if (warning == told) {
        return false;
    }
    told = warning;
    if (!warning.empty()) {
        log_->warn("{}", warning);
    }
    return true;
}

}  // namespace sweepcast::device
