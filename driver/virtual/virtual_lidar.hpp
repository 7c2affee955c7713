// VirtualLidar: a scanner on a pseudo terminal or a network, for those who have none. Joins the
// emulator to time and a port.
#pragma once

#include "driver/protocol/result.hpp"
#include "driver/virtual/emulator.hpp"
#include "driver/virtual/host_port.hpp"
#include "driver/virtual/port_link.hpp"
#include "driver/virtual/recording.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <spdlog/logger.h>

#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
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
    std::vector<std::string> faults{};  ///< see add_fault()
    std::string world{};                ///< file of points; empty: the built-in living room
    std::string serial{};               ///< 32 hex digits; empty: derived from model, link and seed
    std::string recording{};            ///< file for the measurement bytes sent (see Recording)
    std::optional<double> noise_mm{};   ///< standard deviation of distances; unset: the persona's
    double dropout{};                   ///< part of measurements without an echo, 0..1
    std::uint64_t seed{1};              ///< of noise, dropouts and damage on the line
};

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

    /// What a host opens: the path of the pseudo terminal, e.g. /dev/pts/5, or a URL.
    [[nodiscard]] const std::string& port() const { return port_->address(); }

    /// Plays the scanner until stop() or cancellation; called once. The link is gone when it ends.
    /// Throws what made it impossible to go on.
    boost::asio::awaitable<void> run();

    /// Ends run(), also one that has not begun.
    void stop();

private:
    struct Parts;
    explicit VirtualLidar(Parts&& parts);

    boost::asio::awaitable<void> read_host();
    boost::asio::awaitable<void> keep_pace();
    void note_host(bool present);
    void live_until(Moment moment);
    void deliver(const Transmitted& transmitted);
    [[nodiscard]] std::uint32_t host_baud() const;
    void report_losses(Moment moment);
    void log_event(const Event& event);

    std::shared_ptr<spdlog::logger> logger_;
    boost::asio::any_io_executor executor_;
    std::unique_ptr<HostPort> port_;
    bool any_baud_;
    std::optional<PortLink> link_;
    std::optional<Recording> recording_;
    std::unique_ptr<Playback> playback_;
    const Persona* persona_;
    Emulator emulator_;
    boost::asio::steady_timer next_step_;
    boost::asio::steady_timer line_time_;
    boost::asio::steady_timer stopped_;
    std::vector<Transmitted> transmitted_;
    std::exception_ptr failure_;
    std::uint64_t lost_bytes_{};
    std::uint64_t reported_bytes_{};
    Moment reported_at_{};
    bool host_present_{};
    bool stopping_{};
};

}  // namespace sweepcast::virtual_lidar
