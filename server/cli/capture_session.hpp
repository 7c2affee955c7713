// CaptureSession: one capture, from opening the link to giving it back.
#pragma once

#include "driver/async/notifier.hpp"
#include "driver/device/conversation.hpp"
#include "driver/device/probe.hpp"
#include "driver/device/scan.hpp"
#include "driver/link/link_url.hpp"
#include "driver/link/tee_link.hpp"
#include "driver/protocol/result.hpp"
#include "server/cli/capture_progress.hpp"
#include "server/cli/capture_recorder.hpp"
#include "server/cli/output_file.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sweepcast::cli {

struct CaptureOptions {
    link::LinkUrl url;
    /// Line speeds at which to look for the lidar first.
    std::vector<std::uint32_t> baud_hints{};
    /// Name or id of the scan mode; empty: the typical one.
    std::string mode{};
    /// Turns a second; 0: the lidar's usual speed.
    double speed_hz{};
    /// From the first samples on; none: until stop().
    std::optional<std::chrono::nanoseconds> length{};
    /// Of the capture; "-" is standard output, empty: one made of the lidar's name and the time.
    std::string path{};
    Existing existing{Existing::refuse};
};

/// All members are to be called on its executor.
class CaptureSession : private link::LinkTap, private device::ScanObserver {
public:
    CaptureSession(boost::asio::any_io_executor executor, CaptureOptions options);

    /// Finds the lidar, scans and records until stop(), until the length is reached or something
    /// breaks; ends with the scan stopped, the motor off, the port closed and the file whole.
    /// The Problem says what broke, and what is kept.
    boost::asio::awaitable<Result<void, Problem>> run();

    /// Makes run() end.
    void stop();

private:
    boost::asio::awaitable<Result<std::unique_ptr<link::Link>, Problem>> open();
    boost::asio::awaitable<void> until_stopped();
    boost::asio::awaitable<Result<void, Problem>> hold(device::Conversation& talk);
    boost::asio::awaitable<Result<void, Problem>> capture(
        device::Conversation& talk,
        const device::Identity& identity,
        const device::ScanMode& mode
    );
    boost::asio::awaitable<error_code> scan(
        device::Conversation& talk,
        const device::Identity& identity,
        const device::ScanMode& mode
    );
    Result<void, Problem> verdict(const error_code& ended);
    [[nodiscard]] CaptureTotals totals() const;

    void on_read(std::span<const std::uint8_t> bytes) override;
    void on_write(std::span<const std::uint8_t> bytes) override;
    void on_set_baud(std::uint32_t baud) override;
    void on_first_samples() override;
    void on_revolution(protocol::Sweep sweep, protocol::AnswerType type) override;
    void on_progress(const protocol::UnfinishedSweep&, protocol::AnswerType, protocol::SampleTime)
        override {}

    boost::asio::any_io_executor executor_;
    CaptureOptions options_;
    async::Notifier stopped_;
    boost::asio::steady_timer length_;
    link::Link* link_{};  ///< the open one, while there is one
    bool stopping_{};
    CaptureRecorder recorder_;
    std::optional<OutputFile> file_;
    CaptureProgress progress_;
    device::LineQuality line_;
    std::uint64_t sweeps_{};
    std::optional<std::chrono::steady_clock::time_point> first_samples_;
    std::chrono::steady_clock::time_point last_read_{};
};

/// A name for the capture of this lidar, e.g. "A1M8-1A2B3C4D-20260131T120000Z.sweepcast".
[[nodiscard]] std::string
default_capture_name(const device::Identity& identity, std::chrono::system_clock::time_point now);

}  // namespace sweepcast::cli
