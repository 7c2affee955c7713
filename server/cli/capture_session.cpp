#include "server/cli/capture_session.hpp"

#include "driver/device/advice.hpp"
#include "driver/device/error.hpp"
#include "driver/device/motor.hpp"
#include "driver/device/speed_regulator.hpp"
#include "driver/link/error.hpp"
#include "driver/link/open_link.hpp"
#include "server/version.hpp"

#include <boost/asio/experimental/awaitable_operators.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sweepcast::cli {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;

namespace {

Problem stopped_early() {
    return {
        make_error_code(boost::system::errc::operation_canceled),
        "stopped before anything was captured",
        ""};
}

capture::CaptureHeader
header_of(const device::Identity& identity, const device::ScanMode& mode, std::uint32_t baud) {
    const auto& info = identity.info;
    return {
        .program = std::string("sweepcast ") + version,
        .model = device::shown_name(identity),
        .model_id = info.model,
        .serial = protocol::serial_text(info.serial),
        .firmware = fmt::format("{}.{:02}", info.firmware_major, info.firmware_minor),
        .hardware = info.hardware,
        .mode = mode.name,
        .mode_id = mode.id,
        .answer_type = mode.answer_type,
        .sample_duration = mode.sample_duration,
        .baud = baud};
}

/// What is wrong with what the user wants of this lidar, if anything.
std::optional<Problem>
wish_problem(const device::Identity& identity, const CaptureOptions& options) {
    if (!options.mode.empty() && device::find_mode(identity.modes, options.mode) == nullptr) {
        return device::unknown_mode(options.mode, identity.modes);
    }
    if (identity.health.status == protocol::HealthStatus::error) {
        return device::advice(device::errc::protection_stop);
    }
    return device::speed_problem(options.speed_hz, identity.motor, true);
}

}  // namespace

CaptureSession::CaptureSession(asio::any_io_executor executor, CaptureOptions options)
    : executor_(executor)
    , options_(std::move(options))
    , stopped_(executor)
    , length_(executor) {}

void CaptureSession::stop() {
    if (std::exchange(stopping_, true)) {
        return;  // a second interrupt would disturb the farewell
    }
    if (link_ != nullptr) {
        link_->interrupt();
    }
    stopped_.notify();
}

asio::awaitable<Result<void, Problem>> CaptureSession::run() {
    auto opened = co_await open();
    if (!opened) {
        co_return opened.error();
    }
    link::TeeLink link(std::move(*opened), *this);
    link_ = &link;
    device::Conversation talk(link);
    auto held = co_await hold(talk);
    link_ = nullptr;
    length_.cancel();
    co_return held;
}

/// Given up when told to stop: a connection over a network takes its time.
asio::awaitable<Result<std::unique_ptr<link::Link>, Problem>> CaptureSession::open() {
    using namespace asio::experimental::awaitable_operators;
    const auto bauds = device::bauds_for(options_.url, options_.baud_hints);
    auto first =
        co_await (link::open_link(executor_, options_.url, bauds.front()) || until_stopped());
    if (auto* opened = std::get_if<0>(&first)) {
        co_return std::move(*opened);
    }
    co_return stopped_early();
}

asio::awaitable<void> CaptureSession::until_stopped() {
    while (!stopping_) {
        co_await stopped_.wait_until(Clock::time_point::max());
    }
}

/// Gets to know the lidar and captures what it says, if it can be had as it is wanted.
asio::awaitable<Result<void, Problem>> CaptureSession::hold(device::Conversation& talk) {
    auto bauds = device::bauds_for(options_.url, options_.baud_hints);
    const auto probed = co_await device::probe_open(talk, options_.url, std::move(bauds));
    if (stopping_) {
        co_return recorder_.ok()
            ? stopped_early()
            : Problem{{}, "the lidar does not stop talking", "switch it off and on"};
    }
    if (!probed) {
        co_return probed.error();
    }
    const auto& identity = probed->identity;
    if (auto problem = wish_problem(identity, options_)) {
        co_return std::move(*problem);
    }
    const auto* mode = options_.mode.empty() ? device::best_mode(identity.modes)
                                             : device::find_mode(identity.modes, options_.mode);
    if (mode == nullptr) {
        co_return device::unknown_mode(options_.mode, identity.modes);
    }
    co_return co_await capture(talk, identity, *mode);
}

asio::awaitable<Result<void, Problem>> CaptureSession::capture(
    device::Conversation& talk,
    const device::Identity& identity,
    const device::ScanMode& mode
) {
    if (options_.path.empty()) {
        options_.path = default_capture_name(identity, std::chrono::system_clock::now());
    }
    auto created = OutputFile::create(options_.path, options_.existing);
    if (!created) {
        co_return created.error();
    }
    file_.emplace(std::move(*created));
    const auto header = header_of(identity, mode, talk.link().baud());
    progress_.begin(header, options_.path);
    auto ended = error_code();
    if (recorder_.begin(file_->stream(), header)) {
        ended = co_await scan(talk, identity, mode);
    }
    co_return verdict(ended);
}

/// One scan, and whatever it takes to end it. Gives what ended it.
asio::awaitable<error_code> CaptureSession::scan(
    device::Conversation& talk,
    const device::Identity& identity,
    const device::ScanMode& mode
) {
    device::SpeedRegulator regulator(identity.motor);
    regulator.want(options_.speed_hz);
    device::Scan scan(talk, mode, identity.motor.control, regulator, line_, *this);
    const auto ended = co_await scan.run();
    if (ended.error() != link::errc::disconnected) {
        // The line may be gone all the same; then there is nobody to say goodbye to.
        (void)co_await talk.silence();
        (void)co_await device::stop_motor(talk, identity.motor.control);
    }
    co_return ended.error();
}

Result<void, Problem> CaptureSession::verdict(const error_code& ended) {
    progress_.end(totals(), options_.path);
    if (const auto failed = file_->close()) {
        const bool unread =
            failed == boost::system::errc::timed_out || failed == boost::system::errc::broken_pipe;
        return Problem{
            failed,
            fmt::format(
                "cannot write {}: {}",
                options_.path == "-" ? "to standard output" : options_.path,
                unread ? "nobody reads it any more" : failed.message()
            ),
            "what was written before it can still be decoded and played"};
    }
    if (stopping_) {
        return {};
    }
    auto problem = device::advice(ended);
    problem.cause += "; what it said until then is kept in " + options_.path;
    return problem;
}

CaptureTotals CaptureSession::totals() const {
    const auto length = first_samples_ ? last_read_ - *first_samples_ : Clock::duration::zero();
    return {length, recorder_.bytes(), sweeps_, line_};
}

void CaptureSession::on_read(std::span<const std::uint8_t> bytes) {
    const auto now = Clock::now();
    if (!recorder_.record(capture::Direction::from_device, now, bytes)) {
        stop();
        return;
    }
    last_read_ = stopping_ ? last_read_ : now;
    if (file_) {
        progress_.update(totals());
    }
}

void CaptureSession::on_write(std::span<const std::uint8_t> bytes) {
    if (!recorder_.record(capture::Direction::to_device, Clock::now(), bytes)) {
        stop();
    }
}

void CaptureSession::on_set_baud(std::uint32_t) {
    recorder_.forget();
}

void CaptureSession::on_first_samples() {
    first_samples_ = last_read_;
    if (options_.length) {
        length_.expires_after(std::chrono::duration_cast<Clock::duration>(*options_.length));
        length_.async_wait([this](const error_code& cancelled) {
            if (!cancelled) {
                stop();
            }
        });
    }
}

void CaptureSession::on_revolution(protocol::Sweep, protocol::AnswerType) {
    ++sweeps_;
}

std::string
default_capture_name(const device::Identity& identity, std::chrono::system_clock::time_point now) {
    constexpr std::size_t longest_name = 32;
    auto name = device::shown_name(identity).substr(0, longest_name);
    // The lidar told it: nothing that means something to a shell or a file system.
    std::ranges::replace_if(
        name,
        [](char c) {
            const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
            return !letter && !(c >= '0' && c <= '9') && c != '-';
        },
        '_'
    );
    if (name.starts_with('-')) {
        name.front() = '_';
    }
    return fmt::format(
        "{}-{}-{:%Y%m%dT%H%M%SZ}.sweepcast",
        name,
        protocol::short_serial_text(identity.info.serial),
        fmt::gmtime(std::chrono::system_clock::to_time_t(now))
    );
}

}  // namespace sweepcast::cli
