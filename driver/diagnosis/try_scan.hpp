// Tries a scan: does the motor turn, do revolutions come, and how clean do they arrive?
#pragma once

#include "driver/device/motor_traits.hpp"
#include "driver/device/scan_mode.hpp"
#include "driver/diagnosis/scan_findings.hpp"
#include "driver/link/link.hpp"

#include <boost/asio/awaitable.hpp>

#include <memory>
#include <string>

namespace sweepcast::diagnosis {

/// What has to be known of a lidar to have it scan.
struct ScanSetup {
    std::string model;  ///< its name
    device::MotorTraits motor;
    device::ScanMode mode;
};

/// What a scan showed. The others mean nothing if `spin` has no samples.
struct Trial {
    SpinLook spin;
    SweepLook sweep;
    QualityLook quality;
    device::Rotation rotation;
};

/// Has the lidar scan for some revolutions, then ends the scan and stops the motor, also if it is
/// cancelled meanwhile; then closes the link. Takes at most 4 s after the first samples, which may
/// take up to 8 s themselves.
/// Throws boost::system::system_error (operation_aborted) if the coroutine is cancelled.
boost::asio::awaitable<Trial> try_scan(std::unique_ptr<link::Link> link, ScanSetup setup);

}  // namespace sweepcast::diagnosis
