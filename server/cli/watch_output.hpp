// What `sweepcast watch` prints: CSV, JSON lines or a live table.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "sweepcast/v1/lidar.pb.h"
#include "sweepcast/v1/stream.pb.h"

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>

namespace sweepcast::cli {

/// Where a watcher's findings go. All of it is written to standard output, errors and notes to
/// standard error.
class WatchOutput {
public:
    virtual ~WatchOutput() = default;
    virtual void on_lidar(const v1::Lidar& lidar) = 0;
    /// `bytes` is the frame's size on the wire.
    virtual void on_sweep(const device::CapturedSweep& sweep, std::size_t bytes) = 0;
    virtual void on_stats(const v1::StreamStats& stats) = 0;
};

/// A header line, then a line a sample: lidar,sequence,unix_ns,angle_deg,distance_mm,quality,flag.
/// Angles and distances have enough digits to give back the lidar's own units exactly.
[[nodiscard]] std::unique_ptr<WatchOutput> make_csv_output();

/// A line a sweep: the LatestScan message of the API as JSON.
[[nodiscard]] std::unique_ptr<WatchOutput> make_json_output();

/// A line a lidar, rewritten in place on a terminal, printed once a second elsewhere.
[[nodiscard]] std::unique_ptr<WatchOutput> make_table_output();

}  // namespace sweepcast::cli
