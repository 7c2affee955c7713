// What `sweepcast watch` prints: CSV, JSON lines or a live table.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "driver/protocol/result.hpp"
#include "sweepcast/v1/lidar.pb.h"
#include "sweepcast/v1/stream.pb.h"

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>

namespace sweepcast::cli {

/// Where a watcher's findings go. Sweeps and the table are written to standard output; the note
/// that frames were dropped goes to standard error, so that it does not mix with the CSV or JSON.
class WatchOutput {
public:
    virtual ~WatchOutput() = default;
    /// The gateway's greeting, with all lidars.
    virtual void on_hello(const v1::Hello& hello) = 0;
    virtual void on_lidar(const v1::Lidar& lidar) = 0;
    /// `bytes` is the frame's size on the wire.
    virtual void on_sweep(const device::CapturedSweep& sweep, std::size_t bytes) = 0;
    virtual void on_stats(const v1::StreamStats& stats) = 0;
    /// Nothing more will come.
    virtual void on_end() = 0;

    /// Why standard output took no more, e.g. that the disk is full; no error while all is well.
    [[nodiscard]] error_code write_error() const { return write_error_; }

protected:
    /// Writes to standard output, at once.
    void write(const std::string& text);

private:
    error_code write_error_;
};

/// A header line, then a line a sample: lidar,sequence,unix_ns,angle_deg,distance_mm,quality,flag.
/// Angles and distances have enough digits to give back the lidar's own units exactly.
[[nodiscard]] std::unique_ptr<WatchOutput> make_csv_output();

/// A line a sweep: the LatestScan message of the API as JSON.
[[nodiscard]] std::unique_ptr<WatchOutput> make_json_output();

/// A line a lidar, rewritten in place on a terminal, printed once a second elsewhere; in any case
/// after the greeting and at the end.
[[nodiscard]] std::unique_ptr<WatchOutput> make_table_output();

}  // namespace sweepcast::cli
