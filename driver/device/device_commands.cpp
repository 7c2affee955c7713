// What the users of a lidar can have it do, and the waits until it has done so.
#include "driver/device/advice.hpp"
#include "driver/device/device.hpp"
#include "driver/device/error.hpp"

#include <utility>

namespace sweepcast::device {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

constexpr auto start_limit = 10s;
constexpr auto stop_limit = 3s;
/// Booting takes up to 15 s.
constexpr auto reset_limit = 15s + start_limit;

/// Returns whether there is no connection to the lidar now; the device goes on looking for it.
bool is_away(Phase phase) {
    return phase == Phase::absent || phase == Phase::backing_off;
}

/// Returns whether no command can have an effect there, until something changes by itself.
bool is_out_of_reach(Phase phase) {
    return is_away(phase) || phase == Phase::failed;
}

}  // namespace

asio::awaitable<Result<void, Problem>> Device::start(std::string mode) {
    if (!mode.empty() && !state_.modes.empty() && find_mode(state_.modes, mode) == nullptr) {
        co_return unknown_mode(mode, state_.modes);
    }
    const bool names_mode = !mode.empty();
    const bool other_mode = names_mode && mode != wanted_.mode;
    if (other_mode) {
        wanted_.mode = std::move(mode);
    }
    if (!std::exchange(wanted_.scanning, true) || other_mode) {
        ++wanted_.command;
        if (state_.phase == Phase::idle && !wanted_.in_demand) {  // stays so, for another reason
            tell_rest();
        }
    }
    const auto lacks_mode = [this] { return !state_.modes.empty() && wanted_mode() == nullptr; };
    const auto settled = co_await settle(
        [this, names_mode, lacks_mode] {
            if (!wanted_.in_demand) {
                return this->settled();
            }
            if (lacks_mode()) {
                return names_mode || state_.phase == Phase::scanning;
            }
            const auto* mode_wanted = wanted_mode();
            return state_.phase == Phase::scanning && mode_wanted != nullptr &&
                   mode_wanted->name == state_.mode;
        },
        start_limit
    );
    if (settled && names_mode && lacks_mode()) {
        // Asked for before it was known which modes there are.
        co_return unknown_mode(std::exchange(wanted_.mode, ""), state_.modes);
    }
    co_return settled;
}

asio::awaitable<Result<void, Problem>> Device::set_mode(std::string mode) {
    if (wanted_.scanning) {
        co_return co_await start(std::move(mode));
    }
    const auto* found = find_mode(state_.modes, mode);
    if (found == nullptr && !state_.modes.empty()) {
        co_return unknown_mode(mode, state_.modes);
    }
    wanted_.mode = std::move(mode);
    if (found != nullptr) {
        state_.mode = found->name;
        if (state_.phase == Phase::idle) {  // what was said of another mode
            state_.cause.clear();
            state_.hint.clear();
        }
        tell_state();
    }
    co_return Result<void, Problem>{};
}

Result<void, Problem> Device::set_speed(double hz) {
    if (auto problem = speed_problem(hz, motor_, state_.info.has_value())) {
        return std::move(*problem);
    }
    if (hz == wanted_.speed_hz) {
        return {};  // the regulator would begin anew
    }
    wanted_.speed_hz = hz;
    regulator_.want(hz);
    state_.rotation = regulator_.rotation();
    tell_state();
    return {};
}

void Device::set_demand(bool demand) {
    if (std::exchange(wanted_.in_demand, demand) != demand && wanted_.scanning) {
        poke();
    }
}

asio::awaitable<Result<void, Problem>> Device::stop() {
    if (std::exchange(wanted_.scanning, false)) {
        ++wanted_.command;
        if (state_.phase == Phase::idle) {  // stays so, for another reason
            tell_rest();
        }
    }
    co_return co_await settle(
        [this] {
            return state_.phase == Phase::idle || state_.phase == Phase::protection_stop ||
                   state_.phase == Phase::disconnected || is_out_of_reach(state_.phase);
        },
        stop_limit
    );
}

asio::awaitable<Result<void, Problem>> Device::reset() {
    if (!std::exchange(wanted_.reset, true)) {
        ++wanted_.command;
    }
    auto done = co_await settle([this] { return !wanted_.reset && settled(); }, reset_limit);
    if (!done && done.error().code == errc::pending && is_away(state_.phase)) {
        // An attempt to reach the lidar begins from scratch: nothing of a reset is kept for it.
        wanted_.reset = false;
        co_return Problem{make_error_code(errc::not_ready), done.error().cause, done.error().hint};
    }
    co_return done;
}

asio::awaitable<Result<std::optional<Diagnosis>, Problem>> Device::diagnose(Examine examine) {
    if (wanted_.shutdown) {
        co_return advice(errc::shutting_down);
    }
    const auto settled_by = Clock::now() + start_limit;
    const auto on_its_way = [this] {
        return state_.phase == Phase::starting || state_.phase == Phase::stopping;
    };
    for (bool in_time = true; on_its_way() && !wanted_.shutdown && in_time;) {
        in_time = co_await changed_.wait_until(settled_by);
    }
    if (in_hand()) {
        co_return std::optional<Diagnosis>();
    }
    if (!examination_) {
        examination_ = std::make_shared<Examination>(Examination{std::move(examine)});
        poke();
    }
    const auto wanted = examination_;
    while (examination_ == wanted && !wanted_.shutdown) {
        co_await changed_.wait_until(Clock::time_point::max());
    }
    if (wanted->result || wanted->came_into_hand) {
        co_return wanted->result;
    }
    co_return advice(wanted_.shutdown ? errc::shutting_down : errc::internal);
}

bool Device::in_hand() const {
    switch (state_.phase) {
    case Phase::idle:
    case Phase::starting:
    case Phase::scanning:
    case Phase::stopping:
    case Phase::protection_stop:
    case Phase::failed:
        return link_ != nullptr;
    case Phase::disconnected:
    case Phase::absent:
    case Phase::opening:
    case Phase::identifying:
    case Phase::stalled:
    case Phase::resetting:
    case Phase::backing_off:
        break;
    }
    return false;
}

/// Waits until a command has taken effect, or cannot any more.
asio::awaitable<Result<void, Problem>>
Device::settle(std::function<bool()> reached, std::chrono::milliseconds limit) {
    const auto command = wanted_.command;
    const auto version = state_.changes;
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
        const bool stopped_for_good =
            state_.phase == Phase::protection_stop && !wanted_.to_scan() && !wanted_.reset;
        const bool failed = is_out_of_reach(state_.phase) || stopped_for_good;
        if (failed && (state_.changes != version || state_.phase == Phase::absent)) {
            const auto code = is_away(state_.phase) ? errc::pending : errc::not_ready;
            co_return Problem{make_error_code(code), state_.cause, state_.hint};
        }
        const bool changed = co_await changed_.wait_until(deadline);
        if (!changed && !reached()) {
            co_return still_pending(state_.phase);
        }
    }
    co_return Result<void, Problem>{};
}

}  // namespace sweepcast::device
