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
#include <random>
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
    Port port,
    DeviceOptions options,
    DeviceObserver& observer,
    std::shared_ptr<spdlog::logger> log
)
    : port_(std::move(port))
    , options_(std::move(options))
    , observer_(observer)
    , log_(std::move(log))
    , supervisor_(state_, options_.recovery, std::random_device{}())
    , commanded_(executor)
    , changed_(executor) {
    wanted_.scanning = options_.scan_at_once;
    wanted_.mode = options_.mode;
    wanted_.speed_hz = options_.speed_hz;
}

asio::awaitable<void> Device::run() {
    while (!wanted_.shutdown) {
        if (examination_) {
            co_await examine();
            continue;
        }
        auto life = live();
        const auto problem = co_await guarded(std::move(life));
        // A lidar that takes long to boot must not be reset again by each attempt to reach it.
        wanted_.reset = false;
        if (!wanted_.shutdown && !examination_) {
            co_await await_attempt(problem);
        }
    }
    happened(Event::shutdown);
}

/// After a failure: waits until the lidar is worth another attempt.
asio::awaitable<void> Device::await_attempt(const Problem& problem) {
    if (is_absence(problem.code)) {
        tell_failure(problem, "waiting for it");
        happened(Event::no_port, problem);
        co_await pause_until(Clock::now() + options_.look_interval);
        co_return;
    }
    if (!port_.has_moved || !port_.has_moved()) {
        tell_failure(problem, "trying again");
    }
    happened(Event::lost, problem);
    co_await pause_until(supervisor_.next_attempt());
}

/// Until then, or until a command comes or the port changes.
asio::awaitable<void> Device::pause_until(Clock::time_point then) {
    using namespace asio::experimental::awaitable_operators;
    if (port_.wait_for_change) {
        co_await (commanded_.wait_until(then) || port_.wait_for_change(then));
    } else {
        co_await commanded_.wait_until(then);
    }
}

void Device::shut_down() {
    wanted_.shutdown = true;
    poke();
    changed_.notify();  // whoever waits for a command to take effect need wait no more
}

/// Lets an examination have the port.
asio::awaitable<void> Device::examine() {
    using namespace asio::experimental::awaitable_operators;
    happened(Event::examine, {{}, "being examined", ""});
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
    happened(Event::attempt);
    auto opened = co_await open();
    if (!opened) {
        co_return opened.error();
    }
    happened(Event::opened);
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
    auto opening = port_.open(bauds().front());
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
    const auto examined_now = [this] { return examination_ && state_.phase == Phase::stalled; };
    while (!wanted_.shutdown && !examined_now()) {
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
    const auto found = co_await find_baud(talk, candidates, state_.info.has_value());
    if (!found) {
        co_return found.error();
    }
    if (port_.is_it && !port_.is_it(found->info)) {
        co_return make_error_code(errc::another_lidar);
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
    if (port_.baud_hint) {
        hints.push_back(port_.baud_hint());
    }
    hints.push_back(state_.line.baud);
    hints.insert(hints.end(), options_.baud_hints.begin(), options_.baud_hints.end());
    return bauds_to_try(hints);
}

asio::awaitable<Result<void>> Device::next_step(Conversation& talk) {
    if (wanted_.reset) {
        supervisor_.refill_resets();
        const Problem told{{}, "its user resets it", ""};
        const auto rebooted = co_await reboot(talk, told);
        wanted_.reset = wanted_.reset && !rebooted;
        co_return rebooted;
    }
    if (state_.health && state_.health->status == protocol::HealthStatus::error) {
        co_return co_await leave_protection(talk);
    }
    if (wanted_.to_scan()) {
        co_return co_await scan(talk);
    }
    co_return co_await rest(talk);
}

/// Motor off; waits for a command.
asio::awaitable<Result<void>> Device::rest(Conversation& talk) {
    const auto off = co_await stop_motor(talk, motor_.control);
    if (!off) {
        co_return off;
    }
    tell_rest();
    co_return co_await watch_health(talk);
}

/// Tells that the motor is off and why: nobody watches, or its user wants it so.
void Device::tell_rest() {
    happened(Event::rest, wanted_.scanning ? unwatched() : mode_problem());
}

/// Waits until the lidar's health changes. Asks now and then whether it is still there and well:
/// one that does not scan says nothing by itself when its cable is pulled or its protection stop
/// ends.
asio::awaitable<Result<void>> Device::watch_health(Conversation& talk) {
    const auto known = state_.health;
    while (state_.health == known) {
        const auto listened = co_await listen_until(talk, Clock::now() + options_.health_interval);
        if (!listened) {
            co_return listened;
        }
        const auto health = co_await ask_health(talk);
        if (!health) {
            co_return health.error();
        }
        state_.health = *health;
    }
    co_return Result<void>{};
}

/// Reads what the lidar says unasked, such as leftovers of a scan or of a boot.
asio::awaitable<Result<void>> Device::listen_until(Conversation& talk, Clock::time_point then) {
    while (Clock::now() < then) {
        const auto heard = co_await talk.read(then);
        if (!heard && heard.error() != link::errc::timed_out) {
            co_return heard.error();
        }
    }
    co_return Result<void>{};
}

/// A lidar in protection stop is reset so that it goes on, as long as it may be; if in vain, or if
/// no scan is wanted, it is left alone until its user sees to it or it is well again.
asio::awaitable<Result<void>> Device::leave_protection(Conversation& talk) {
    const auto off = co_await stop_motor(talk, motor_.control);
    if (!off) {
        co_return off;
    }
    const auto problem = protection_problem(state_.health->code);
    happened(Event::protect, problem);
    if (!wanted_.to_scan()) {
        co_return co_await watch_health(talk);
    }
    if (!supervisor_.may_reset(Moment::now())) {
        const auto advice = reset_in_vain(supervisor_.resets_taken(), state_.health->code);
        tell_failure(advice, "no more resets by itself");
        happened(Event::give_up, advice);
        co_return co_await watch_health(talk);
    }
    tell_failure(problem, "resetting it");
    const auto waited = co_await listen_until(talk, Clock::now() + supervisor_.reset_wait());
    if (!waited) {
        co_return waited;
    }
    supervisor_.count_reset(Moment::now());
    co_return co_await reboot(talk, problem);
}

/// RESET, then asks until the lidar has booted (protocol.md 11.2: poll, do not sleep blindly).
asio::awaitable<Result<void>> Device::reboot(Conversation& talk, const Problem& why) {
    happened(Event::reset, why);
    const protocol::Request reset{protocol::Command::reset, {}};
    if (auto sent = co_await talk.send(reset); !sent) {
        co_return sent;
    }
    const auto deadline = Clock::now() + boot_limit;
    for (;;) {
        auto identity = co_await identify(talk);
        if (identity) {
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

/// Takes what happened to the lidar, and tells of it.
void Device::happened(Event event, const Problem& why) {
    const auto before = state_.phase;
    const auto failing_since = state_.failing_since;
    const bool changed = supervisor_.on(event, why, Moment::now());
    if (failing_since && !state_.failing_since && event != Event::shutdown) {
        const auto took = std::chrono::duration<double>(state_.since - *failing_since).count();
        log_->info("{} again, after {:.1f} s", name(state_.phase), took);
        told_failure_.clear();
    } else if (state_.phase != before) {
        // Attempts that fail again as they did before are no news.
        const auto level = told_failure_.empty() ? spdlog::level::info : spdlog::level::debug;
        log_->log(level, "{}", name(state_.phase));
    }
    if (in_hand() && examination_) {  // asked for while it was being reset, or had just answered
        examination_->came_into_hand = true;
        examination_.reset();
    }
    if (changed || state_.phase != Phase::absent) {  // looked for in vain once more is no news
        tell_state();
    }
}

void Device::tell_state() {
    told_at_ = Clock::now();
    observer_.on_state(state_);
    changed_.notify();
}

/// Warns of a failure and of what is done next, once for as long as the next attempts fail for the
/// same reason.
void Device::tell_failure(const Problem& problem, std::string_view next) {
    if (problem.cause == told_failure_) {
        return;
    }
    told_failure_ = problem.cause;
    const auto* const colon = problem.hint.empty() ? "" : ": ";
    log_->warn("{}{}{}; {}", problem.cause, colon, problem.hint, next);
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
    return state_.phase == (wanted_.to_scan() ? Phase::scanning : Phase::idle);
}

}  // namespace sweepcast::device
