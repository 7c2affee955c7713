// Diagnose: walks the chain from a lidar's port to its first sweeps, up to the first thing wrong.
#pragma once

#include "driver/device/device_state.hpp"
#include "driver/diagnosis/finding.hpp"
#include "driver/link/link_url.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace sweepcast::diagnosis {

/// Examines the lidar at `url`, at the line speed in the URL, else at the `baud_hints` and the
/// usual ones; `on_check` (may be empty) hears of each check as soon as it is done. A port that
/// another process has open is not touched. What is started is ended: no scan goes on and no motor
/// turns afterwards, also if it is cancelled. Takes some seconds, at most about 25.
/// Throws boost::system::system_error (operation_aborted) if the coroutine is cancelled.
boost::asio::awaitable<Diagnosis> diagnose(
    boost::asio::any_io_executor executor,
    link::LinkUrl url,
    std::vector<std::uint32_t> baud_hints,
    OnCheck on_check
);

/// What the state of a lidar that is in hand (Device::in_hand) tells, without asking it anything.
/// Checks that only a scan can answer are not run unless it scans. Pure.
[[nodiscard]] Diagnosis diagnosis_of(const device::DeviceState& state, const link::LinkUrl& url);

}  // namespace sweepcast::diagnosis
