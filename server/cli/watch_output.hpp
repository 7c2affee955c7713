// What `sweepcast watch` prints: CSV, JSON lines or a live table.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/client/event.hpp"

#include <memory>
#include <string>

namespace sweepcast::cli {

/// Where a watcher's findings go. Scans and the table are written to standard output. With CSV and
/// JSON, notes (frames were dropped, the connection is lost) go to standard error, so that they do
/// not mix; the table shows such things itself.
class WatchOutput {
public:
    virtual ~WatchOutput() = default;
    /// The gateway's greeting, with all lidars; again after each reconnect.
    virtual void on_connected(const client::Connected& connected) = 0;
    virtual void on_disconnected(const client::Disconnected& disconnected) = 0;
    virtual void on_lidar(const v1::Lidar& lidar) = 0;
    virtual void on_scan(const client::Scan& scan) = 0;
    virtual void on_stats(const v1::StreamStats& stats) = 0;
    /// A refusal that may pass: the lidar is not there yet.
    virtual void on_refusal(const v1::StreamError& refusal) = 0;
    /// The gateway says more than a client keeps.
    virtual void on_left_out(const client::LeftOut& left_out) = 0;
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

/// A header line, then one line per sample: lidar,sequence,unix_ns,angle_deg,distance_mm,quality,
/// flag; with `sectors` also sector, after sequence. A field is empty if its value is not
/// known, for example because the subscription leaves that column out. Angles and distances have
/// enough digits to give back the lidar's own units exactly.
[[nodiscard]] std::unique_ptr<WatchOutput> make_csv_output(bool sectors);

/// A line a scan: the LatestScan message of the API as JSON.
[[nodiscard]] std::unique_ptr<WatchOutput> make_json_output();

/// A line a lidar, rewritten in place on a terminal, printed once a second elsewhere; in any case
/// after the greeting and at the end.
[[nodiscard]] std::unique_ptr<WatchOutput> make_table_output();

}  // namespace sweepcast::cli
