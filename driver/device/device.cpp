#include "driver/device/device.hpp"

#include "driver/async/task_group.hpp"
#include "driver/device/advice.hpp"
#include "driver/device/error.hpp"
#include "driver/device/find_baud.hpp"
#include "driver/device/motor.hpp"
#include "driver/link/error.hpp"
#include "driver/protocol/model.hpp"

#include <boost/asio/experimental/awaitable_operators.hpp>

#include <algorithm>
#include <exception>
#include <utility>

namespace sweepcast::device {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

constexpr auto boot_limit = 15s;

/// Closes a borrowed pointer's life with the scope that owns the object.
class Lend {
public:
    Lend(link::Link*& slot, link::Link& link) : slot_(slot) { slot = &link; }
    ~Lend() { slot_ = nullptr; }
    Lend(const Lend&) = delete;
    Lend& operator=(const Lend&) = delete;

private:
    link::Link*& slot_;
};

/// What `part` gives, with what must not happen (a broken invariant, no memory) made a failure like
/// others. A cancellation passes: the owner ends this life.
template <class T>
asio::awaitable<T> guarded(asio::awaitable<T> part) {
    try {
        co_return co_await std::move(part);
    } catch (const std::exception& failure) {
        if (async::is_cancellation(std::current_exception())) {
            throw;
        }
        co_return T(Problem{make_error_code(errc::internal), failure.what(), "please report this"});
    }
}

}  // namespace

Device::Device(
    asio::any_io_executor executor,
    OpenLink open_link,
    DeviceOptions options,
    DeviceObserver& observer,
    std::shared_ptr<spdlog::logger> log
)
    : open_link_(std::move(open_link))
    , options_(std::move(options))
    , observer_(observer)
    , log_(std::move(log))
    , commanded_(executor)
    , changed_(executor) {
    wanted_.scanning = options_.scan_at_once;
    wanted_.mode = options_.mode;
    wanted_.speed_hz = options_.speed_hz;
    state_.since = std::chrono::system_clock::now();
}

asio::awaitable<void> Device::run() {
    while (!wanted_.shutdown) {
        if (examination_) {
            co_await examine();
            continue;
        }
        auto life = live();
        const auto problem = co_await guarded(std::move(life));
        wanted_.reset = false;  // the next attempt begins from scratch anyway
        if (wanted_.shutdown || examination_) {
            continue;
        }
        tell_failure(problem);
        set_phase(Phase::failed, problem);
        co_await commanded_.wait_until(Clock::now() + options_.retry_delay);
    }
    set_phase(Phase::disconnected);
}

void Device::shut_down() {
    wanted_.shutdown = true;
    poke();
    changed_.notify();  // whoever waits for a command to take effect need wait no more
}

/// Lets an examination have the port.
asio::awaitable<void> Device::examine() {
    using namespace asio::experimental::awaitable_operators;
    set_phase(Phase::identifying, {{}, "being examined", ""});
    auto first = co_await (examination_result() || until_shutdown());
    if (auto* diagnosis = std::get_if<0>(&first)) {
        examination_->result = std::move(*diagnosis);
    }
    examination_.reset();
    changed_.notify();
}

/// What the examination finds; nothing if it fails. (Of two that race, `||` would wait for the
/// other if this one threw.)
asio::awaitable<std::optional<Diagnosis>> Device::examination_result() {
    try {
        co_return co_await examination_->examine();
    } catch (const std::exception& failure) {
        if (async::is_cancellation(std::current_exception())) {
            throw;
        }
        log_->error("the examination failed: {}", failure.what());
    }
    co_return std::nullopt;
}

/// One connection, from opening the port to losing it. Returns what ended it.
asio::awaitable<Problem> Device::live() {
    set_phase(Phase::identifying);
    auto opened = co_await open();
    if (!opened) {
        co_return opened.error();
    }
    const auto link = std::move(*opened);
    const Lend lend(link_, *link);
    Conversation talk(*link);
    auto holding = hold(talk);
    auto problem = co_await guarded(std::move(holding));
    if (problem.code == errc::internal) {
        (void)co_await talk.silence();  // nobody did: a scan may be going on
    }
    // However it ended: nobody wants the motor to turn now. The line may be gone, too.
    (void)co_await stop_motor(talk, motor_.control);
    co_return problem;
}

/// Opens the link; given up at shutdown, as a connection over a network takes its time.
asio::awaitable<Result<std::unique_ptr<link::Link>, Problem>> Device::open() {
    using namespace asio::experimental::awaitable_operators;
    auto opening = open_link_(bauds().front());
    auto first = co_await (guarded(std::move(opening)) || until_shutdown());
    if (auto* opened = std::get_if<0>(&first)) {
        co_return std::move(*opened);
    }
    co_return Problem{make_error_code(errc::shutting_down), "", ""};
}

asio::awaitable<void> Device::until_shutdown() {
    while (!wanted_.shutdown) {
        co_await commanded_.wait_until(Clock::time_point::max());
    }
}

/// Identifies the lidar and does what is wanted of it, until the line breaks or it does not answer.
asio::awaitable<Problem> Device::hold(Conversation& talk) {
    auto met = co_await meet(talk);
    while (!met && met.error() == link::errc::interrupted && !wanted_.shutdown && !examination_) {
        met = co_await meet(talk);
    }
    if (!met) {
        co_return advice(met.error());
    }
    while (!wanted_.shutdown) {
        const auto step = co_await next_step(talk);
        if (!step && step.error() != link::errc::interrupted) {
            co_return advice(step.error());
        }
    }
    co_return Problem{};
}

/// Finds the lidar on its line and gets to know it.
asio::awaitable<Result<void>> Device::meet(Conversation& talk) {
    const auto found = co_await find(talk);
    if (!found) {
        co_return found;
    }
    auto identity = co_await identify(talk);
    if (!identity) {
        co_return identity.error();
    }
    adopt(std::move(*identity));
    co_return Result<void>{};
}

/// Finds the line speed of the lidar, and talks it into the one that was asked for.
asio::awaitable<Result<void>> Device::find(Conversation& talk) {
    const auto candidates = bauds();
    log_->debug("looking for it at {} baud", fmt::join(candidates, ", "));
    const auto found = co_await find_baud(talk, candidates);
    if (!found) {
        co_return found.error();
    }
    state_.line = {.baud = found->baud};
    const auto wish = options_.baud.value_or(found->baud);
    if (wish == found->baud || talk.link().is_network()) {
        co_return Result<void>{};
    }
    auto followed = Result<void>(make_error_code(errc::baud_refused));
    if (protocol::knows_baud_negotiation(found->info)) {
        followed = co_await negotiate_baud(talk, wish);
    }
    if (followed) {
        log_->info("talked into {} baud, from {}", wish, found->baud);
        state_.line.baud = wish;
    } else if (followed.error() == errc::baud_refused) {
        log_->warn("the lidar speaks at {} baud and not at {}: using that", found->baud, wish);
        followed = Result<void>{};
    }
    co_return followed;
}

/// Line speeds in the order in which to try them.
std::vector<std::uint32_t> Device::bauds() const {
    std::vector<std::uint32_t> hints;
    if (options_.baud) {
        hints.push_back(*options_.baud);
    }
    hints.push_back(state_.line.baud);
    hints.insert(hints.end(), options_.baud_hints.begin(), options_.baud_hints.end());
    return bauds_to_try(hints);
}

asio::awaitable<Result<void>> Device::next_step(Conversation& talk) {
    if (wanted_.reset) {
        co_return co_await reboot(talk);
    }
    if (state_.health && state_.health->status == protocol::HealthStatus::error) {
        co_return co_await idle(talk, Phase::protection_stop);
    }
    if (wanted_.scanning) {
        co_return co_await scan(talk);
    }
    co_return co_await idle(talk, Phase::idle);
}

/// Motor off; waits for a command. Asks now and then whether the lidar is still there and well: an
/// idle one says nothing by itself when its cable is pulled or its protection stop ends.
asio::awaitable<Result<void>> Device::idle(Conversation& talk, Phase phase) {
    const auto off = co_await stop_motor(talk, motor_.control);
    if (!off) {
        co_return off;
    }
    const auto known = state_.health;
    set_phase(
        phase,
        phase == Phase::protection_stop ? advice(errc::protection_stop) : mode_problem()
    );
    while (state_.health == known) {
        const auto ask_at = Clock::now() + options_.health_interval;
        while (Clock::now() < ask_at) {
            const auto heard = co_await talk.read(ask_at);  // leftovers of a scan or of a boot
            if (!heard && heard.error() != link::errc::timed_out) {
                co_return heard.error();
            }
        }
        const auto health = co_await ask_health(talk);
        if (!health) {
            co_return health.error();
        }
        state_.health = *health;
    }
    co_return Result<void>{};
}

asio::awaitable<Result<void>> Device::scan(Conversation& talk) {
    const auto* mode = wanted_mode();
    if (mode == nullptr) {
        mode = best_mode(state_.modes);
    }
    if (mode == nullptr) {
        co_return make_error_code(errc::unknown_mode);
    }
    mode_ = *mode;
    state_.mode = mode_.name;
    regulator_.want(wanted_.speed_hz);
    state_.rotation = regulator_.rotation();
    set_phase(Phase::starting);
    begun_before_scan_ = begun_;
    Scan scan(talk, mode_, motor_.control, regulator_, state_.line, *this);
    const auto ended = co_await scan.run();
    regulator_.stopped();
    state_.rotation = regulator_.rotation();
    if (ended.error() == link::errc::disconnected) {
        co_return ended;
    }
    set_phase(Phase::stopping);
    const auto silent = co_await talk.silence();
    if (!silent && silent.error() != link::errc::interrupted) {
        co_return silent;
    }
    co_return ended;
}

void Device::on_first_samples() {
    set_phase(Phase::scanning, mode_problem());
}

void Device::on_revolution(protocol::Sweep sweep, protocol::AnswerType type) {
    report_scan();
    begin_sweep(sweep.begun);
    CapturedSweep captured;
    captured.sweep = std::move(sweep);
    captured.sweep.begun = begun_;
    captured.mode = mode_.name;
    captured.answer_type = type;
    captured.sample_duration = std::chrono::round<std::chrono::microseconds>(mode_.sample_duration);
    captured.monotonic_to_unix = monotonic_to_unix_;
    captured.clock_step = std::exchange(clock_step_, {});
    captured.sequence = ++sequence_;
    observer_.on_sweep(std::move(captured));
}

void Device::on_progress(
    const protocol::UnfinishedSweep& sweep,
    protocol::AnswerType type,
    protocol::SampleTime arrival
) {
    begin_sweep(sweep.begun);
    SweepProgress progress;
    progress.sweep = sweep;
    progress.sweep.begun = begun_;
    progress.sequence = sequence_ + 1;
    progress.mode = mode_.name;
    progress.answer_type = type;
    progress.sample_duration = std::chrono::round<std::chrono::microseconds>(mode_.sample_duration);
    progress.monotonic_to_unix = monotonic_to_unix_;
    progress.clock_step = clock_step_;
    progress.arrival = arrival;
    observer_.on_progress(progress);
}

/// Notes which sweep of the scan is under way; reads the clocks once for each.
void Device::begin_sweep(std::uint64_t begun) {
    begun += begun_before_scan_;
    if (begun == begun_) {
        return;
    }
    begun_ = begun;
    const auto relation = wall_clock_.take(read_clocks());
    monotonic_to_unix_ = relation.monotonic_to_unix;
    clock_step_ += relation.step;  // a sweep that is given up leaves it to the next one
}

/// Tells the speed and the state of the line: at once when the speed is reached or lost, else now
/// and then.
void Device::report_scan() {
    const bool was_settled = std::exchange(state_.rotation, regulator_.rotation()).settled;
    if (state_.rotation.warning != told_warning_) {
        told_warning_ = state_.rotation.warning;
        if (!told_warning_.empty()) {
            log_->warn("{}", told_warning_);
        }
    } else if (state_.rotation.settled == was_settled && Clock::now() - told_at_ < options_.report_interval) {
        return;
    }
    tell_state();
}

/// RESET, then asks until the lidar has booted (protocol.md 11.2: poll, do not sleep blindly).
asio::awaitable<Result<void>> Device::reboot(Conversation& talk) {
    log_->info("resetting the lidar");
    set_phase(Phase::identifying, {{}, "resetting", ""});
    const protocol::Request reset{protocol::Command::reset, {}};
    if (auto sent = co_await talk.send(reset); !sent) {
        co_return sent;
    }
    const auto deadline = Clock::now() + boot_limit;
    for (;;) {
        auto identity = co_await identify(talk);
        if (identity) {
            wanted_.reset = false;
            adopt(std::move(*identity));
            co_return Result<void>{};
        }
        const bool just_late =
            identity.error() == errc::no_answer || identity.error() == link::errc::interrupted;
        if (!just_late || wanted_.shutdown || Clock::now() >= deadline) {
            co_return identity.error();
        }
    }
}

void Device::adopt(Identity identity) {
    log_->info(
        "{} serial {} firmware {}.{:02} hardware {}{}",
        shown_name(identity),
        protocol::serial_text(identity.info.serial),
        identity.info.firmware_major,
        identity.info.firmware_minor,
        identity.info.hardware,
        state_.line.baud > 0 ? fmt::format(", {} baud", state_.line.baud) : ""
    );
    state_.info = identity.info;
    state_.health = identity.health;
    state_.modes = std::move(identity.modes);
    state_.alias = std::move(identity.alias);
    motor_ = identity.motor;
    regulator_ = SpeedRegulator(motor_);
    regulator_.want(wanted_.speed_hz);
    state_.rotation = regulator_.rotation();
    const auto* mode = wanted_mode();
    if (mode == nullptr) {
        const auto problem = mode_problem();
        log_->warn("{}: {}", problem.cause, problem.hint);
        mode = best_mode(state_.modes);
    }
    if (mode != nullptr) {
        state_.mode = mode->name;
    }
}

/// That the lidar lacks the mode in which it was told to scan, if so: no reason not to scan.
Problem Device::mode_problem() const {
    if (wanted_mode() != nullptr || state_.modes.empty()) {
        return {};
    }
    auto problem = unknown_mode(wanted_.mode, state_.modes);
    problem.cause += ": taking the one that the lidar recommends";
    return problem;
}

void Device::set_phase(Phase phase, const Problem& why) {
    if (phase == Phase::scanning || phase == Phase::idle) {
        told_failure_.clear();
    }
    if (state_.phase != phase) {
        // Attempts that fail again as they did before are no news.
        log_->log(
            told_failure_.empty() ? spdlog::level::info : spdlog::level::debug,
            "{}",
            name(phase)
        );
    }
    state_.phase = phase;
    state_.cause = why.cause;
    state_.hint = why.hint;
    state_.since = std::chrono::system_clock::now();
    ++state_version_;
    if (in_hand() && examination_) {  // asked for while it was being reset, or had just answered
        examination_->came_into_hand = true;
        examination_.reset();
    }
    tell_state();
}

void Device::tell_state() {
    told_at_ = Clock::now();
    observer_.on_state(state_);
    changed_.notify();
}

/// Warns of a failure, once for as long as the next attempts fail for the same reason.
void Device::tell_failure(const Problem& problem) {
    if (problem.cause == told_failure_) {
        return;
    }
    told_failure_ = problem.cause;
    log_->warn(
        "{}{}{}; trying again every {} ms",
        problem.cause,
        problem.hint.empty() ? "" : ": ",
        problem.hint,
        options_.retry_delay.count()
    );
}

/// Makes run() look at what is wanted.
void Device::poke() {
    if (link_ != nullptr) {
        link_->interrupt();
    }
    commanded_.notify();
}

const ScanMode* Device::wanted_mode() const {
    return wanted_.mode.empty() ? best_mode(state_.modes) : find_mode(state_.modes, wanted_.mode);
}

/// In the phase that is wanted, with nothing left to do.
bool Device::settled() const {
    return state_.phase == (wanted_.scanning ? Phase::scanning : Phase::idle);
}

}  // namespace sweepcast::device
