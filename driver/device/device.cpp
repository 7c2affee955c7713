#include "driver/device/device.hpp"

#include "driver/device/advice.hpp"
#include "driver/device/error.hpp"
#include "driver/device/probe.hpp"
#include "driver/link/error.hpp"
#include "driver/protocol/decode.hpp"
#include "driver/protocol/model.hpp"
#include "driver/protocol/sweep_assembler.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <utility>

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
/// Between switching the motor and the next request, as the vendor's SDK does (protocol.md 4.3).
constexpr auto motor_pause = 10ms;
constexpr auto boot_limit = 15s;

constexpr auto start_limit = 10s;
constexpr auto stop_limit = 3s;
constexpr auto reset_limit = boot_limit + start_limit;

constexpr std::uint16_t usual_pwm = 660;

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
    state_.since = std::chrono::system_clock::now();
}

asio::awaitable<void> Device::run() {
    while (!wanted_.shutdown) {
        const auto problem = co_await live_guarded();
        wanted_.reset = false;  // the next attempt begins from scratch anyway
        if (wanted_.shutdown) {
            break;
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

asio::awaitable<Result<void, Problem>> Device::start(std::string mode) {
    if (!mode.empty() && !state_.modes.empty() && find_mode(state_.modes, mode) == nullptr) {
        co_return unknown_mode(mode, state_.modes);
    }
    const bool other_mode = !mode.empty() && mode != wanted_.mode;
    if (other_mode) {
        wanted_.mode = std::move(mode);
    }
    if (!std::exchange(wanted_.scanning, true) || other_mode) {
        ++wanted_.command;
    }
    co_return co_await settle(
        [this] {
            const auto* mode_wanted = wanted_mode();
            return state_.phase == Phase::scanning && mode_wanted != nullptr &&
                   mode_wanted->name == state_.mode;
        },
        start_limit
    );
}

asio::awaitable<Result<void, Problem>> Device::stop() {
    if (std::exchange(wanted_.scanning, false)) {
        ++wanted_.command;
    }
    co_return co_await settle(
        [this] {
            return state_.phase == Phase::idle || state_.phase == Phase::failed ||
                   state_.phase == Phase::protection_stop || state_.phase == Phase::disconnected;
        },
        stop_limit
    );
}

asio::awaitable<Result<void, Problem>> Device::reset() {
    if (!std::exchange(wanted_.reset, true)) {
        ++wanted_.command;
    }
    co_return co_await settle([this] { return !wanted_.reset && settled(); }, reset_limit);
}

/// Waits until a command has taken effect, or cannot any more.
asio::awaitable<Result<void, Problem>>
Device::settle(std::function<bool()> reached, std::chrono::milliseconds limit) {
    const auto command = wanted_.command;
    const auto version = state_version_;
    const auto deadline = Clock::now() + limit;
    if (!reached()) {
        poke();
    }
    while (!reached()) {
        if (wanted_.shutdown) {
            co_return advice(errc::shutting_down);
        }
        if (wanted_.command != command) {
            co_return advice(errc::superseded);
        }
        const bool failed = state_.phase == Phase::failed || state_.phase == Phase::protection_stop;
        if (failed && state_version_ != version) {
            co_return Problem{make_error_code(errc::not_ready), state_.cause, state_.hint};
        }
        if (!state_.modes.empty() && wanted_mode() == nullptr) {
            // Asked for before it was known which modes there are.
            co_return unknown_mode(std::exchange(wanted_.mode, ""), state_.modes);
        }
        const bool changed = co_await changed_.wait_until(deadline);
        if (!changed && !reached()) {
            co_return not_ready(state_.phase);
        }
    }
    co_return Result<void, Problem>{};
}

/// live(), with what must not happen (a broken invariant, no memory) made a failure like others.
asio::awaitable<Problem> Device::live_guarded() {
    try {
        co_return co_await live();
    } catch (const boost::system::system_error&) {
        throw;  // cancelled: the owner ends this life
    } catch (const std::exception& failure) {
        co_return Problem{make_error_code(errc::internal), failure.what(), "please report this"};
    }
}

/// One connection, from opening the port to losing it. Returns what ended it.
asio::awaitable<Problem> Device::live() {
    set_phase(Phase::identifying);
    auto opened = co_await open_link_(default_baud);
    if (!opened) {
        co_return opened.error();
    }
    const auto link = std::move(*opened);
    const Lend lend(link_, *link);
    Conversation talk(*link);
    auto problem = co_await hold(talk);
    // However it ended: nobody wants the motor to turn now. The line may be gone, too.
    (void)co_await set_motor(talk, false);
    co_return problem;
}

/// Identifies the lidar and does what is wanted of it, until the line breaks or it does not answer.
asio::awaitable<Problem> Device::hold(Conversation& talk) {
    auto identity = co_await identify(talk);
    while (!identity && identity.error() == link::errc::interrupted && !wanted_.shutdown) {
        identity = co_await identify(talk);
    }
    if (!identity) {
        co_return advice(identity.error());
    }
    adopt(std::move(*identity));
    while (!wanted_.shutdown) {
        const auto step = co_await next_step(talk);
        if (!step && step.error() != link::errc::interrupted) {
            co_return advice(step.error());
        }
    }
    co_return Problem{};
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
    if (auto off = co_await set_motor(talk, false); !off) {
        co_return off;
    }
    const auto status = state_.health->status;
    set_phase(phase, phase == Phase::protection_stop ? advice(errc::protection_stop) : Problem{});
    while (state_.health->status == status) {
        const auto ask_at = Clock::now() + options_.health_interval;
        auto heard = co_await talk.read(ask_at);
        while (heard) {  // leftovers of a scan or of a boot
            heard = co_await talk.read(ask_at);
        }
        if (heard.error() != link::errc::timed_out) {
            co_return heard.error();
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
        mode = fastest_mode(state_.modes);
    }
    if (mode == nullptr) {
        co_return make_error_code(errc::unknown_mode);
    }
    state_.mode = mode->name;
    set_phase(Phase::starting);
    if (auto on = co_await set_motor(talk, true); !on) {
        co_return on;
    }
    const auto request = scan_request(*mode);
    const auto descriptor = co_await talk.open_stream(request, descriptor_limit);
    auto ended = Result<void>(descriptor.error());
    if (descriptor) {
        const auto type = static_cast<protocol::AnswerType>(descriptor->type);
        ended = co_await deliver_sweeps(talk, type, *mode);
    }
    if (ended.error() == link::errc::disconnected) {
        co_return ended;
    }
    set_phase(Phase::stopping);
    if (auto silent = co_await talk.silence();
        !silent && silent.error() != link::errc::interrupted) {
        co_return silent;
    }
    if (ended.error() == link::errc::timed_out) {
        co_return make_error_code(descriptor ? errc::stream_silent : errc::no_answer);
    }
    co_return ended;
}

/// Reads, decodes and gives out sweeps until something ends it; never returns success.
asio::awaitable<Result<void>>
Device::deliver_sweeps(Conversation& talk, protocol::AnswerType type, const ScanMode& mode) {
    auto decoder = protocol::Decoder::create(
        type,
        {std::chrono::round<std::chrono::microseconds>(mode.sample_duration),
         link_->baud(),
         link_->is_network()}
    );
    if (!decoder) {
        co_return decoder.error();
    }
    // A network hands over what came in a datagram or segment at once.
    const std::chrono::nanoseconds per_byte(
        link_->is_network() ? 0 : 10'000'000'000LL / std::max(link_->baud(), 1U)
    );
    protocol::SweepAssembler assembler;
    protocol::Decoded decoded;
    std::vector<protocol::Sweep> finished;
    auto deadline = Clock::now() + spin_up_limit;
    for (;;) {
        const auto bytes = co_await talk.read(deadline);
        if (!bytes) {
            co_return bytes.error();
        }
        const auto now = Clock::now();
        decoded.clear();
        decoder->push(
            *bytes,
            {std::chrono::time_point_cast<std::chrono::microseconds>(now), per_byte},
            decoded
        );
        if (decoded.samples.empty()) {
            if (now >= deadline) {  // bytes alone are no scan
                co_return make_error_code(link::errc::timed_out);
            }
            continue;
        }
        deadline = now + silence_limit;
        if (state_.phase != Phase::scanning) {
            set_phase(Phase::scanning);
        }
        finished.clear();
        assembler.push(decoded, finished);
        for (auto& sweep : finished) {
            publish(std::move(sweep), type, mode);
        }
    }
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

/// An A1's motor hangs on the adapter's DTR line and runs while that is released; an A2's on its
/// accessory board, which takes a request. Both are tried, as the field's drivers do: DTR is
/// harmless to an A2, and an A1 ignores the request (protocol.md 5).
asio::awaitable<Result<void>> Device::set_motor(Conversation& talk, bool on) {
    const auto released = link_->set_dtr(!on);
    if (!released && released.error() != link::errc::no_modem_lines) {
        co_return released;
    }
    const auto request = protocol::set_motor_pwm_request(on ? usual_pwm : 0);
    const auto sent = co_await talk.send(request);
    if (sent) {
        asio::steady_timer pause(co_await asio::this_coro::executor, motor_pause);
        co_await pause.async_wait(asio::use_awaitable);
    }
    co_return sent;
}

void Device::adopt(Identity identity) {
    log_->info(
        "{} serial {} firmware {}.{:02} hardware {}",
        protocol::model_name(identity.info.model),
        protocol::serial_text(identity.info.serial),
        identity.info.firmware_major,
        identity.info.firmware_minor,
        identity.info.hardware
    );
    state_.info = identity.info;
    state_.health = identity.health;
    state_.modes = std::move(identity.modes);
    told_failure_.clear();
    const auto* mode = wanted_mode();
    if (mode == nullptr) {
        const auto problem = unknown_mode(wanted_.mode, state_.modes);
        log_->warn("{}: {}; taking the fastest", problem.cause, problem.hint);
        mode = fastest_mode(state_.modes);
    }
    if (mode != nullptr) {
        state_.mode = mode->name;
    }
}

void Device::publish(protocol::Sweep sweep, protocol::AnswerType type, const ScanMode& mode) {
    const std::chrono::nanoseconds unix_now = std::chrono::system_clock::now().time_since_epoch();
    const std::chrono::nanoseconds monotonic_now = Clock::now().time_since_epoch();
    CapturedSweep captured;
    captured.sweep = std::move(sweep);
    captured.mode = mode.name;
    captured.answer_type = type;
    captured.sample_duration = std::chrono::round<std::chrono::microseconds>(mode.sample_duration);
    captured.monotonic_to_unix = unix_now - monotonic_now;
    captured.sequence = ++sequence_;
    observer_.on_sweep(std::move(captured));
}

void Device::set_phase(Phase phase, const Problem& why) {
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
    return wanted_.mode.empty() ? fastest_mode(state_.modes)
                                : find_mode(state_.modes, wanted_.mode);
}

/// In the phase that is wanted, with nothing left to do.
bool Device::settled() const {
    return state_.phase == (wanted_.scanning ? Phase::scanning : Phase::idle);
}

}  // namespace sweepcast::device
