#include "server/cli/watch_output.hpp"

#include "driver/device/captured_sweep.hpp"
#include "server/api/json.hpp"
#include "server/api/scan_export.hpp"
#include "server/cli/print.hpp"
#include "sweepcast/v1/api.pb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <map>
#include <unistd.h>
#include <utility>

namespace sweepcast::cli {

namespace {

using Clock = std::chrono::steady_clock;

/// An output that a program reads: what is for its user goes to standard error.
class LinesOutput : public WatchOutput {
public:
    void on_connected(const client::Connected&) override {
        if (std::exchange(lost_, false)) {
            note("connected again");
        }
    }
    void on_disconnected(const client::Disconnected& disconnected) override {
        if (!std::exchange(lost_, true)) {  // once for all attempts
            note(disconnected.why.cause + "; trying again");
        }
    }
    void on_refusal(const v1::StreamError& refusal) override {
        note(refusal.message() + "; waiting for it");
    }
    void on_stats(const v1::StreamStats& stats) override {
        note(fmt::format(
            "this client reads too slowly: {} frames dropped so far",
            stats.frames_dropped()
        ));
    }
    void on_left_out(const client::LeftOut& left_out) override { note(left_out.why.cause); }
    void on_lidar(const v1::Lidar&) override {}
    void on_end() override {}

private:
    static void note(const std::string& text) { print(stderr, "sweepcast: {}\n", text); }

    bool lost_{};
};

class CsvOutput final : public LinesOutput {
public:
    explicit CsvOutput(bool sectors) : sectors_(sectors) {}

    void on_scan(const client::Scan& scan) override {
        text_.clear();
        if (!std::exchange(header_written_, true)) {
            text_ += sectors_ ? "lidar,sequence,sector," : "lidar,sequence,";
            text_ += "unix_ns,angle_deg,distance_mm,quality,flag\n";
        }
        auto which = fmt::format("{},{}", csv_field(scan.lidar), scan.sequence);
        which += sectors_ ? fmt::format(",{}", scan.sector) : "";
        for (const auto& sample : scan.scan.sweep.samples) {
            const auto unix_time = scan.scan.unix_time(sample);
            fmt::format_to(
                std::back_inserter(text_),
                "{},{},{:.4f},{:.2f},{},{}\n",
                which,
                unix_time ? std::to_string(unix_time->count()) : "",
                scan.scan.degrees(sample),
                sample.distance.millimetres(),
                scan.scan.without_quality ? "" : std::to_string(sample.quality),
                scan.scan.without_flags ? "" : std::to_string(sample.flag)
            );
        }
        write(text_);
    }

private:
    bool sectors_;
    bool header_written_{};
    std::string text_;
};

/// The sweep as the API exports one.
device::CapturedSweep to_captured(const client::Scan& from) {
    device::CapturedSweep captured;
    captured.sweep = from.scan.sweep;
    captured.lidar = from.lidar;
    captured.sequence = from.sequence;
    captured.mode = from.scan.mode;
    captured.answer_type = from.scan.answer_type;
    captured.monotonic_to_unix = from.scan.first_unix - from.scan.first_time.time_since_epoch();
    return captured;
}

/// As the API exports a sweep, without the columns that were left out.
void to_message(const client::Scan& from, v1::LatestScan& message) {
    api::to_message(to_captured(from), message);
    int k = 0;
    for (const auto& sample : from.scan.sweep.samples) {
        message.set_angle_deg(k++, from.scan.degrees(sample));
    }
    if (from.scan.without_times) {
        message.clear_time_us();
    }
    if (from.scan.without_quality) {
        message.clear_quality();
    }
    if (from.kind == v1::SECTOR) {
        message.set_sector(from.sector);
        message.set_last(from.last);
    }
}

class JsonOutput final : public LinesOutput {
public:
    void on_scan(const client::Scan& scan) override {
        v1::LatestScan message;
        to_message(scan, message);
        auto line = api::to_json_line(message);
        line.pop_back();
        write(format_printable("{}\n", line));
    }
};

class TableOutput final : public WatchOutput {
public:
    void on_connected(const client::Connected& connected) override {
        note_.clear();
        left_out_.clear();
        rows_.clear();
        for (const auto& lidar : connected.hello.lidars()) {
            rows_[lidar.number()].lidar = lidar;
        }
        print();
    }

    void on_disconnected(const client::Disconnected& disconnected) override {
        set_note(disconnected.why.cause + "; trying again");
    }

    void on_refusal(const v1::StreamError& refusal) override {
        set_note(refusal.message() + "; waiting for it");
    }

    void on_left_out(const client::LeftOut& left_out) override {
        left_out_ = left_out.why.cause;
        print();
    }

    void on_lidar(const v1::Lidar& lidar) override {
        rows_[lidar.number()].lidar = lidar;
        print_if_due();
    }

    void on_scan(const client::Scan& scan) override {
        const auto row = std::ranges::find_if(rows_, [&](const auto& entry) {
            return entry.second.lidar.id() == scan.lidar;
        });
        if (row == rows_.end()) {
            return;
        }
        note_.clear();
        auto& [number, shown] = *row;
        const bool goes_on = scan.kind == v1::SECTOR && scan.sector > 0;
        shown.points_so_far = (goes_on ? shown.points_so_far : 0) + scan.scan.sweep.samples.size();
        shown.bytes_so_far = (goes_on ? shown.bytes_so_far : 0) + scan.wire_bytes;
        shown.missed += scan.missed;
        if (scan.kind == v1::SWEEP || scan.last) {
            shown.points = shown.points_so_far;
            shown.bytes = shown.bytes_so_far;
            shown.hz = scan.scan.sweep.rotation_hz();
            shown.sequence = scan.sequence;
        }
        print_if_due();
    }

    void on_stats(const v1::StreamStats&) override {}  // the client counts the gaps itself

    void on_end() override {
        if (!rows_.empty()) {
            print();
        }
    }

private:
    struct Row {
        v1::Lidar lidar;
        /// Of the latest sweep, and of the one under way if it comes in sectors.
        std::size_t points{}, points_so_far{};
        std::size_t bytes{}, bytes_so_far{};
        double hz{};
        std::uint64_t sequence{};
        std::uint64_t missed{};
    };

    /// Shows it below the table until a scan comes.
    void set_note(const std::string& text) {
        if (std::exchange(note_, text) != text) {
            print();
        }
    }

    void print_if_due() {
        const auto interval = terminal_ ? std::chrono::milliseconds(100) : std::chrono::seconds(1);
        if (Clock::now() - printed_at_ >= interval) {
            print();
        }
    }

    void print() {
        printed_at_ = Clock::now();
        std::string text;
        if (terminal_ && lines_ > 0) {
            text = fmt::format("\x1b[{}A", lines_);  // back up to the table's first line
        }
        const char* end = terminal_ ? "\x1b[K\n" : "\n";
        text += fmt::format(
            "{:<12} {:<9} {:<15} {:<11} {:>6} {:>7} {:>7} {:>9} {:>7}{}",
            "lidar",
            "model",
            "state",
            "mode",
            "rpm",
            "points",
            "bytes",
            "sweep",
            "missed",
            end
        );
        for (const auto& [number, row] : rows_) {
            text += line(row) + end;
        }
        std::size_t notes = 0;
        for (const auto* note : {&left_out_, &note_}) {
            if (!note->empty()) {
                text += protocol::printable(*note) + end;
                ++notes;
            }
        }
        // What is left of a longer table before.
        text += terminal_ ? "\x1b[J" : "";
        lines_ = 1 + rows_.size() + notes;
        write(text);
    }

    static std::string line(const Row& row) {
        auto text = format_printable(
            "{:<12} {:<9} {:<15} {:<11} {:>6.0f} {:>7} {:>7} {:>9} {:>7}",
            row.lidar.id(),
            row.lidar.device().model(),
            v1::Lidar::State_Name(row.lidar.state()),
            row.lidar.mode(),
            row.hz * 60,
            row.points,
            row.bytes,
            row.sequence,
            row.missed
        );
        return row.lidar.cause().empty() ? text
                                         : text + "  " + protocol::printable(row.lidar.cause());
    }

    const bool terminal_ = isatty(STDOUT_FILENO) != 0;
    std::map<std::uint32_t, Row> rows_;
    Clock::time_point printed_at_{};
    std::size_t lines_{};
    std::string left_out_;  ///< shown as long as the connection is there
    std::string note_;
};

}  // namespace

void WatchOutput::write(const std::string& text) {
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    if (!written || std::fflush(stdout) != 0) {
        write_error_ = error_code(errno, boost::system::generic_category());
    }
}

std::unique_ptr<WatchOutput> make_csv_output(bool sectors) {
    return std::make_unique<CsvOutput>(sectors);
}

std::unique_ptr<WatchOutput> make_json_output() {
    return std::make_unique<JsonOutput>();
}

std::unique_ptr<WatchOutput> make_table_output() {
    return std::make_unique<TableOutput>();
}

}  // namespace sweepcast::cli
