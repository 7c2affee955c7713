// Device: one lidar's life. Opens its port, identifies it, scans and stops as wanted, and brings it
// back when something breaks (STATES.md).
#pragma once

#include "driver/async/notifier.hpp"
#include "driver/device/captured_sweep.hpp"
#include "driver/device/conversation.hpp"
#include "driver/device/device_state.hpp"
#include "driver/device/diagnosis.hpp"
#include "driver/device/identify.hpp"
#include "driver/device/line_watch.hpp"
#include "driver/device/scan.hpp"
#include "driver/device/scan_stamps.hpp"
#include "driver/device/speed_regulator.hpp"
#include "driver/device/supervisor.hpp"
#include "driver/device/sweep_progress.hpp"
#include "driver/link/link.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <spdlog/logger.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::device {

/// Who wants to know what a device does. Called on the device's executor; must not block.
class DeviceObserver {
public:
    virtual ~DeviceObserver() = default;
    virtual void on_state(const DeviceState& state) = 0;
    /// A complete revolution. Its `lidar` is empty: naming lidars is the observer's business.
    virtual void on_sweep(CapturedSweep sweep) = 0;
    /// The revolution under way, whenever the line has brought samples of it: after on_sweep() of
    /// those that the same samples completed.
    virtual void on_progress(const SweepProgress& progress) = 0;
};

/// Opens the device's port anew, at a line speed if it has one; called for every attempt.
using OpenLink = std::function<
    boost::asio::awaitable<Result<std::unique_ptr<link::Link>, Problem>>(std::uint32_t baud)>;

/// The way to a lidar.
struct Port {
    OpenLink open;
    /// Returns when the port may have come or changed since it could not be had, at the latest
    /// then. Empty: nobody can tell, so that only time passes.
    std::function<boost::asio::awaitable<void>(std::chrono::steady_clock::time_point)>
        wait_for_change{};
    /// Whether the lidar that answers there is the one to have. Empty: any is.
    std::function<bool(const protocol::DeviceInfo&)> is_it{};
    /// The line speed at which the lidar was just found there; 0, or empty: not known.
    std::function<std::uint32_t()> baud_hint{};
    /// Whether the lidar is known to be elsewhere since open() was last called, so that its loss is
    /// no news. Empty: it never is.
    std::function<bool()> has_moved{};
};

/// Examines the lidar and its port from outside.
using Examine = std::function<boost::asio::awaitable<Diagnosis>()>;

struct DeviceOptions {
    /// Start scanning as soon as the device is there.
    bool scan_at_once{true};
    /// Name or id of the scan mode; empty: the typical one.
    std::string mode{};
    /// Turns a second; 0: the lidar's usual speed.
    double speed_hz{};
    /// The line speed to use. A lidar that speaks at another is talked into it if it can be.
    std::optional<std::uint32_t> baud{};
    /// Line speeds at which to look for it first.
    std::vector<std::uint32_t> baud_hints{};
    RecoveryPolicy recovery{};
    /// How often to look for a port that is not there, if nobody tells that it has come.
    std::chrono::milliseconds look_interval{500};
    /// How often to ask a lidar that does not scan whether it is there and well.
    std::chrono::milliseconds health_interval{2000};
    /// How often to tell the measured speed and the state of the line while scanning.
    std::chrono::milliseconds report_interval{2000};
};

/// One lidar, on one executor; all members are to be called on it.
class Device : private ScanObserver {
public:
    Device(
        boost::asio::any_io_executor executor,
        Port port,
        DeviceOptions options,
        DeviceObserver& observer,
        std::shared_ptr<spdlog::logger> log
    );
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    /// Lives until shut_down(); ends with the scan stopped, the motor off and the port closed.
    boost::asio::awaitable<void> run();

    /// Makes run() end.
    void shut_down();

    /// Scans, in the mode of that name or id (empty: as before). Returns once samples come in.
    /// Errors: errc::unknown_mode, pending (the lidar is away or slow; the command is kept),
    /// not_ready (the lidar has failed), superseded, shutting_down.
    boost::asio::awaitable<Result<void, Problem>> start(std::string mode);

    /// Ends the scan. Returns once the motor has been switched off, at once if there is no lidar.
    /// Errors: errc::pending, superseded, shutting_down.
    boost::asio::awaitable<Result<void, Problem>> stop();

    /// Reboots the lidar (RESET, protocol.md 11.2); a scan that was wanted is started again.
    /// Returns once the lidar has answered and, where wanted, scans. Errors: as start(), but a
    /// pending reset is kept only as long as the connection lasts; not_ready also if there is no
    /// lidar, because a reset is not kept for one that comes later.
    boost::asio::awaitable<Result<void, Problem>> reset();

    /// Has it scan in another mode from now on, or from the next start on. Returns once it does.
    /// Errors: as start().
    boost::asio::awaitable<Result<void, Problem>> set_mode(std::string mode);

    /// Has it turn at `hz` from now on, 0: at its usual speed. Returns at once: its state tells
    /// when the speed is reached. Errors: errc::no_such_speed, fixed_speed.
    Result<void, Problem> set_speed(double hz);

    /// Whether somebody wants what it sees. While nobody does a scan that is wanted rests, motor
    /// off; at first somebody does.
    void set_demand(bool demand);

    /// Has `examine` look at a lidar that is not in hand, while the device keeps away from the
    /// port; who asks meanwhile gets the same answer. Nothing if the lidar is in hand, or comes
    /// into hand before the examination has begun: its state tells all there is to tell. A scan
    /// that is just starting or stopping is awaited. Errors: errc::shutting_down, internal.
    boost::asio::awaitable<Result<std::optional<Diagnosis>, Problem>> diagnose(Examine examine);

    /// Whether the lidar has been identified on the connection that is open, and does as it is
    /// told.
    [[nodiscard]] bool in_hand() const;

    [[nodiscard]] const DeviceState& state() const { return state_; }

private:
    /// What the users of the lidar want of it. `command` counts the changes of mind.
    struct Wanted {
        bool scanning{};
        std::string mode{};
        double speed_hz{};
        bool in_demand{true};
        bool reset{};
        bool shutdown{};
        std::uint64_t command{};

        [[nodiscard]] bool to_scan() const { return scanning && in_demand; }
    };

    /// An examination that was asked for.
    struct Examination {
        Examine examine;
        std::optional<Diagnosis> result{};
        bool came_into_hand{};  ///< before it began
    };

    boost::asio::awaitable<void> examine();
    boost::asio::awaitable<std::optional<Diagnosis>> examination_result();
    boost::asio::awaitable<Problem> live();
    boost::asio::awaitable<void> await_attempt(const Problem& problem);
    boost::asio::awaitable<void> pause_until(std::chrono::steady_clock::time_point then);
    boost::asio::awaitable<Result<std::unique_ptr<link::Link>, Problem>> open();
    boost::asio::awaitable<Problem> hold(Conversation& talk);
    boost::asio::awaitable<Result<void>> meet(Conversation& talk);
    boost::asio::awaitable<Result<void>> find(Conversation& talk);
    boost::asio::awaitable<Result<void>> next_step(Conversation& talk);
    boost::asio::awaitable<Result<void>> rest(Conversation& talk);
    boost::asio::awaitable<Result<void>> watch_health(Conversation& talk);
    boost::asio::awaitable<Result<void>> leave_protection(Conversation& talk);
    boost::asio::awaitable<Result<void>> scan(Conversation& talk);
    boost::asio::awaitable<Result<void>> restart_stalled(Conversation& talk, error_code why);
    boost::asio::awaitable<Result<void>> reboot(Conversation& talk, const Problem& why);
    boost::asio::awaitable<Result<void>>
    listen_until(Conversation& talk, std::chrono::steady_clock::time_point then);
    boost::asio::awaitable<void> until_shutdown();
    boost::asio::awaitable<Result<void, Problem>>
    settle(std::function<bool()> reached, std::chrono::milliseconds limit);

    void on_first_samples() override;
    void on_silence(bool over) override;
    void on_revolution(protocol::Sweep sweep, protocol::AnswerType type) override;
    void on_progress(
        const protocol::UnfinishedSweep& sweep,
        protocol::AnswerType type,
        protocol::SampleTime arrival
    ) override;

    void adopt(Identity identity);
    [[nodiscard]] std::vector<std::uint32_t> bauds() const;
    void report_scan();
    bool tell_warning(std::string& told, const std::string& warning);
    void happened(Event event, const Problem& why = {});
    void tell_rest();
    void tell_state();
    void tell_failure(const Problem& problem, std::string_view next);
    void poke();
    [[nodiscard]] const ScanMode* wanted_mode() const;
    [[nodiscard]] Problem mode_problem() const;
    [[nodiscard]] bool settled() const;

    Port port_;
    DeviceOptions options_;
    DeviceObserver& observer_;
    std::shared_ptr<spdlog::logger> log_;

    Wanted wanted_;
    DeviceState state_;
    Supervisor supervisor_;
    std::chrono::steady_clock::time_point told_at_{};
    MotorTraits motor_;
    SpeedRegulator regulator_{motor_};
    ScanStamps stamps_;
    LineWatch line_watch_;
    std::uint32_t restarts_{};  ///< of stalled scans since a turn was last complete
    std::string told_failure_;  ///< the cause that the log was last told; empty once all is well
    std::string told_warning_;  ///< of the rotation
    std::string told_line_warning_;
    link::Link* link_{};                        ///< the open one, while there is one
    std::shared_ptr<Examination> examination_;  ///< wanted or under way
    async::Notifier commanded_;
    async::Notifier changed_;
};

}  // namespace sweepcast::device
