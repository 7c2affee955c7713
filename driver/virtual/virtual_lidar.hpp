// VirtualLidar: a scanner on a pseudo terminal or a network, for those who have none. Joins the
// emulator to time and a port.
#pragma once

#include "driver/async/notifier.hpp"
#include "driver/protocol/result.hpp"
#include "driver/virtual/control_socket.hpp"
#include "driver/virtual/emulator.hpp"
#include "driver/virtual/fault_command.hpp"
#include "driver/virtual/fault_schedule.hpp"
#include "driver/virtual/host_port.hpp"
#include "driver/virtual/port_link.hpp"
#include "driver/virtual/recording.hpp"
#include "driver/virtual/truth_file.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <spdlog/logger.h>

#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::virtual_lidar {

/// What a user can choose. Empty texts: not asked for.
struct VirtualLidarOptions {
    std::string model{"a1m8"};  ///< key of a persona
    std::string listen{};       ///< see parse_listen_address(); empty: a pseudo terminal
    std::string link{};         ///< path of a symbolic link to the pseudo terminal
    std::string play{};         ///< a capture to play instead of measuring; its model counts
    bool loop{};                ///< play it again and again
    bool any_baud{};            ///< whatever speed a host sets, it is understood
    std::vector<std::string> faults{};    ///< see add_fault()
    std::vector<std::string> schedule{};  ///< see FaultSchedule::add()
    std::string control{};                ///< path of a ControlSocket; empty: none
    std::string world{};                  ///< file of points; empty: the built-in living room
    std::string serial{};     ///< 32 hex digits; empty: derived from model, link and seed
    std::string recording{};  ///< file for the measurement bytes sent (see Recording)
    std::string truth{};      ///< file for what it measured (see TruthFile)
    /// Told of every packet that it measured, on its executor. May be empty.
    std::function<void(const Measured&)> on_measured{};
    std::optional<double> noise_mm{};  ///< standard deviation of distances; unset: the persona's
    double dropout{};                  ///< part of measurements without an echo, 0..1
    std::uint64_t seed{1};             ///< of noise, dropouts and damage on the line
};

/// How a virtual lidar is just now, and what has happened to its measurements so far.
struct VirtualLidarStatus {
    std::string port{};  ///< where it is, or was before it was unplugged
    bool plugged{};
    bool host_present{};
    std::string_view scan_mode{};  ///< empty: it does not scan
    Faults faults{};
    std::uint64_t replugs{};
    DamageCounters damage{};  ///< by noise, loss and doubling on the line
    /// Measurement and other bytes that the host did not read in time. What is lost so damages
    /// packets too, which `damage` does not tell. Nor do either tell what a flood adds, or what a
    /// host with another speed hears.
    std::uint64_t unread_bytes{};
};

/// The status as the control socket answers it: "port=/dev/pts/5 plugged=yes host=yes scan=Standard
/// faults=noise=0.02,mute replugs=0 packets=3120 damaged=12 undetectable=1 unread_bytes=0"; "none"
/// for no scan and no faults.
[[nodiscard]] std::string to_text(const VirtualLidarStatus& status);

/// A virtual lidar. It is used on the thread of its executor only.
class VirtualLidar {
public:
    /// Opens the port, the link and the recording, and loads the world. The scanner has its power
    /// from then on; a host may open the port before run() is called. Errors: errc of this room,
    /// each with a cause and a hint for the user.
    static Result<std::unique_ptr<VirtualLidar>, Problem> create(
        boost::asio::any_io_executor executor,
        const VirtualLidarOptions& options,
        std::shared_ptr<spdlog::logger> logger
    );

    VirtualLidar(const VirtualLidar&) = delete;
    VirtualLidar& operator=(const VirtualLidar&) = delete;

    /// What a host opens: the path of the pseudo terminal, e.g. /dev/pts/5, or a URL. While it is
    /// unplugged, where it was; plugged in again, a pseudo terminal has another path.
    [[nodiscard]] const std::string& port() const { return address_; }

    /// Plays the scanner until stop() or cancellation; called once. The link is gone when it ends.
    /// Throws what made it impossible to go on.
    boost::asio::awaitable<void> run();

    /// Ends run(), also one that has not begun.
    void stop();

    /// Does what the command says, at once: after unplug the host's reads fail and the link is
    /// gone, after replug the port and the link are there. Also before run(). A fault that is
    /// begun while it is unplugged shows when it is plugged in. Errors: not_now if that cannot be
    /// (it is unplugged already), port_unavailable and link_unavailable of a replug, which leaves
    /// it unplugged, and invalid_option.
    Result<void, Problem> obey(const FaultCommand& command);

    /// Obeys a line as the control socket takes it, "status" or a command (see
    /// parse_fault_command()), and gives what that answers: "ok", for a status "ok " and its text,
    /// or "error: CAUSE: HINT".
    std::string obey_line(std::string_view line);

    [[nodiscard]] bool is_plugged() const { return port_ != nullptr; }
    [[nodiscard]] VirtualLidarStatus status() const;

private:
    struct Parts;
    explicit VirtualLidar(Parts&& parts);

    Result<void, Problem> unplug();
    Result<void, Problem> replug(const std::string& link);
    Result<void, Problem> set_faults(const Faults& faults);
    Result<void, Problem> suffer(const Suffer& command);
    void obey_schedule(Moment moment);
    void log_listening() const;
    void note_measured(const Measured& measured);
    void flood();
    [[nodiscard]] std::optional<Moment> next_due(Moment moment) const;
    boost::asio::awaitable<void> read_host();
    boost::asio::awaitable<void> wait_for_news(std::shared_ptr<HostPort> port);
    boost::asio::awaitable<void> keep_pace();
    void note_host(bool present);
    void live_until(Moment moment);
    void deliver(const Transmitted& transmitted);
    [[nodiscard]] std::uint32_t host_baud() const;
    void report_losses(Moment moment);
    void log_event(const Event& event);

    std::shared_ptr<spdlog::logger> logger_;
    boost::asio::any_io_executor executor_;
    std::shared_ptr<HostPort> port_;  // null while it is unplugged
    std::string address_;
    std::string listen_;  // of the port, empty for a pseudo terminal
    bool any_baud_;
    std::optional<PortLink> link_;
    std::string link_path_;
    std::optional<Recording> recording_;
    std::optional<TruthFile> truth_;
    std::function<void(const Measured&)> on_measured_;
    std::unique_ptr<Playback> playback_;
    const Persona* persona_;
    Faults faults_;  // while it is unplugged its emulator does not know of them
    FaultSchedule schedule_;
    Moment switched_on_;
    std::unique_ptr<ControlSocket> control_;
    Emulator emulator_;
    async::Notifier plugged_in_;
    boost::asio::steady_timer next_step_;
    boost::asio::steady_timer line_time_;
    boost::asio::steady_timer stopped_;
    std::vector<Transmitted> transmitted_;
    std::exception_ptr failure_;
    std::uint64_t lost_bytes_{};
    std::uint64_t reported_bytes_{};
    Moment reported_at_{};
    std::uint64_t replugs_{};
    bool host_present_{};
    bool stopping_{};
};

}  // namespace sweepcast::virtual_lidar
