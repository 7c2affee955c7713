#include "driver/diagnosis/try_scan.hpp"

#include "driver/device/conversation.hpp"
#include "driver/device/error.hpp"
#include "driver/device/identify.hpp"
#include "driver/device/motor.hpp"
#include "driver/device/scan.hpp"
#include "driver/device/speed_regulator.hpp"
#include "driver/link/error.hpp"
#include "driver/link/tee_link.hpp"

#include <boost/asio/error.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/system/system_error.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>
#include <vector>

namespace sweepcast::diagnosis {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using device::Conversation;

namespace {

/// Enough to see a line that loses one packet in a hundred.
constexpr std::uint64_t enough_sweeps = 8;
/// For a speed that has to settle first.
constexpr auto settle_limit = 3s;
constexpr auto sweeps_limit = 4s;
/// What comes instead of samples shows within so many bytes.
constexpr std::size_t text_at_most = 4096;

std::chrono::milliseconds since(Clock::time_point start) {
    return std::chrono::round<std::chrono::milliseconds>(Clock::now() - start);
}

/// Looks on while a lidar scans, and ends the scan when enough was seen.
class Onlooker final : public link::LinkTap, public device::ScanObserver {
public:
    Onlooker(const device::SpeedRegulator& regulator, const device::LineQuality& line)
        : regulator_(regulator)
        , line_(line) {}

    /// The link to interrupt; it is made with this as its tap.
    void watch(link::Link& link) { link_ = &link; }

    void on_read(std::span<const std::uint8_t> bytes) override {
        const auto more = std::min(bytes.size(), text_at_most - heard_.size());
        heard_
            .insert(heard_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(more));
        if (first_samples_ && Clock::now() - *first_samples_ > sweeps_limit) {
            link_->interrupt();
        }
    }
    void on_write(std::span<const std::uint8_t>) override {}
    void on_set_baud(std::uint32_t) override {}

    void on_first_samples() override {
        first_samples_ = Clock::now();
        spun_up_ = since(start_);
    }
    void on_revolution(protocol::Sweep sweep, protocol::AnswerType type) override {
        type_ = type;
        ++look_.sweeps;
        look_.samples = sweep.samples.size();
        look_.echoes =
            static_cast<std::uint64_t>(std::ranges::count_if(sweep.samples, [](const auto& sample) {
                return sample.distance.raw > 0;
            }));
        rotation_ = regulator_.rotation();
        const bool late = Clock::now() - *first_samples_ > settle_limit;
        if (look_.sweeps >= enough_sweeps && (late || plausible_speed())) {
            link_->interrupt();
        }
    }
    void on_progress(const protocol::UnfinishedSweep&, protocol::AnswerType, protocol::SampleTime)
        override {}

    [[nodiscard]] bool saw_samples() const { return first_samples_.has_value(); }

    [[nodiscard]] Trial tell(const ScanSetup& setup) const {
        Trial trial;
        trial.spin.model = setup.model;
        trial.spin.control = setup.motor.control;
        trial.spin.mode = setup.mode.name;
        trial.spin.samples = line_.samples;
        trial.spin.waited = first_samples_ ? spun_up_ : since(start_);
        trial.sweep = look_;
        trial.sweep.waited = since(start_);
        if (look_.sweeps == 0) {
            trial.sweep.samples = line_.samples;
        }
        trial.quality = {type_.value_or(setup.mode.answer_type), line_, {}};
        trial.rotation = rotation_;
        return trial;
    }
    [[nodiscard]] Heard heard() const {
        auto heard = classify(line_.baud, heard_);
        heard.bytes = line_.bytes;
        return heard;
    }

private:
    [[nodiscard]] bool plausible_speed() const {
        return judge_speed(rotation_).verdict == Verdict::ok && rotation_.measured_hz > 0;
    }

    const device::SpeedRegulator& regulator_;
    const device::LineQuality& line_;
    link::Link* link_{};
    Clock::time_point start_{Clock::now()};
    std::optional<Clock::time_point> first_samples_;
    std::chrono::milliseconds spun_up_{};
    std::vector<std::uint8_t> heard_;
    std::optional<protocol::AnswerType> type_;
    SweepLook look_;
    device::Rotation rotation_;
};

/// Everything from the motor's start to enough revolutions, or to the reason why there are none.
asio::awaitable<void> look_on(
    Conversation& talk,
    device::Scan& scan,
    const Onlooker& onlooker,
    const ScanSetup& setup,
    Trial& trial
) {
    const auto ended = co_await scan.run();
    trial = onlooker.tell(setup);
    trial.spin.accepted = ended.error() != device::errc::no_answer;
    trial.spin.gone = ended.error() == link::errc::disconnected;
    if (onlooker.saw_samples()) {
        co_return;
    }
    trial.spin.heard = onlooker.heard();
    if (trial.spin.gone) {
        co_return;
    }
    const auto silent = co_await talk.silence();
    if (silent) {
        const auto health = co_await device::ask_health(talk);
        if (health) {
            trial.spin.health_after = *health;
        }
    }
}

}  // namespace

asio::awaitable<Trial> try_scan(std::unique_ptr<link::Link> link, ScanSetup setup) {
    device::SpeedRegulator regulator(setup.motor);
    device::LineQuality line{.baud = link->baud()};
    Onlooker onlooker(regulator, line);
    link::TeeLink tee(std::move(link), onlooker);
    onlooker.watch(tee);
    Conversation talk(tee);
    device::Scan scan(talk, setup.mode, setup.motor.control, regulator, line, onlooker);
    Trial trial;
    std::exception_ptr failure;
    try {
        co_await look_on(talk, scan, onlooker, setup, trial);
    } catch (...) {
        failure = std::current_exception();
    }
    const auto cancellation = co_await asio::this_coro::cancellation_state;
    const bool cancelled = cancellation.cancelled() != asio::cancellation_type::none;
    // What was started is ended, whoever has lost interest.
    co_await asio::this_coro::reset_cancellation_state();
    (void)co_await talk.silence();
    (void)co_await device::stop_motor(talk, setup.motor.control);
    if (failure) {
        std::rethrow_exception(failure);
    }
    if (cancelled) {
        throw boost::system::system_error(asio::error::operation_aborted);
    }
    co_return trial;
}

}  // namespace sweepcast::diagnosis
