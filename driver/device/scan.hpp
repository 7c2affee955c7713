// Scan: one scan, from the motor's start to whatever ends it.
#pragma once

#include "driver/device/conversation.hpp"
#include "driver/device/line_quality.hpp"
#include "driver/device/scan_mode.hpp"
#include "driver/device/speed_regulator.hpp"
#include "driver/protocol/result.hpp"
#include "driver/protocol/sweep.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>

namespace sweepcast::device {

/// Who wants to know what a scan brings.
class ScanObserver {
public:
    virtual ~ScanObserver() = default;
    /// Samples have begun to come in.
    virtual void on_first_samples() = 0;
    /// No samples have come for so long that something is wrong, but the scan is not given up yet;
    /// or that is `over`: they come again.
    virtual void on_silence(bool /*over*/) {}
    /// A complete revolution, as the stream's descriptor has it.
    virtual void on_revolution(protocol::Sweep sweep, protocol::AnswerType type) = 0;
    /// The revolution under way, after bytes that arrived then have brought samples and what they
    /// completed has been told. The samples are valid during the call.
    virtual void on_progress(
        const protocol::UnfinishedSweep& sweep,
        protocol::AnswerType type,
        protocol::SampleTime arrival
    ) = 0;
};

class Scan {
public:
    /// In `mode`, with the motor at the speed that `regulator` says, also while that changes; what
    /// comes over the line is added to `line`. All of them outlive the scan.
    Scan(
        Conversation& talk,
        const ScanMode& mode,
        protocol::MotorControl control,
        SpeedRegulator& regulator,
        LineQuality& line,
        ScanObserver& observer
    )
        : talk_(talk)
        , mode_(mode)
        , control_(control)
        , regulator_(regulator)
        , line_(line)
        , observer_(observer) {}

    /// Starts the motor and the scan, and gives out sweeps until something ends it; never returns
    /// success. The lidar may go on sending, and the motor turns: silence it and stop_motor().
    /// Errors: errc::no_answer if the scan was not accepted, errc::stream_silent if no samples
    /// come (any more), errc::not_turning if they come but no revolution does;
    /// protocol::errc::unsupported_answer_type; those of the link.
    boost::asio::awaitable<Result<void>> run();

private:
    boost::asio::awaitable<Result<void>> obey_regulator();
    boost::asio::awaitable<Result<void>> read_stream(protocol::AnswerType type);
    [[nodiscard]] std::chrono::steady_clock::duration silence_after(protocol::AnswerType type
    ) const;

    Conversation& talk_;
    const ScanMode& mode_;
    protocol::MotorControl control_;
    SpeedRegulator& regulator_;
    LineQuality& line_;
    ScanObserver& observer_;
    std::uint16_t told_{};  ///< what the motor was told last
    std::chrono::steady_clock::time_point samples_due_{};
    std::chrono::steady_clock::time_point turn_due_{};  ///< the next complete revolution
};

}  // namespace sweepcast::device
