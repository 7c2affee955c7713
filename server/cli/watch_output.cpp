#include "server/cli/watch_output.hpp"

#include "server/api/json.hpp"
#include "server/api/scan_export.hpp"
#include "sweepcast/v1/api.pb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <iterator>
#include <unistd.h>

namespace sweepcast::cli {

namespace {

using Clock = std::chrono::steady_clock;

void note_drops(const v1::StreamStats& stats) {
    fmt::print(
        stderr,
        "sweepcast: this client reads too slowly: {} frames dropped so far\n",
        stats.frames_dropped()
    );
}

class CsvOutput final : public WatchOutput {
public:
    void on_hello(const v1::Hello&) override {}
    void on_lidar(const v1::Lidar&) override {}
    void on_end() override {}

    void on_sweep(const device::CapturedSweep& captured, std::size_t) override {
        text_.clear();
        if (!std::exchange(header_written_, true)) {
            text_ += "lidar,sequence,unix_ns,angle_deg,distance_mm,quality,flag\n";
        }
        for (const auto& sample : captured.sweep.samples) {
            const std::chrono::nanoseconds time =
                sample.time.time_since_epoch() + captured.monotonic_to_unix;
            fmt::format_to(
                std::back_inserter(text_),
                "{},{},{},{:.4f},{:.2f},{},{}\n",
                captured.lidar,
                captured.sequence,
                time.count(),
                sample.angle.degrees(),
                sample.distance.millimetres(),
                sample.quality,
                sample.flag
            );
        }
        write(text_);
    }

    void on_stats(const v1::StreamStats& stats) override { note_drops(stats); }

private:
    bool header_written_{};
    std::string text_;
};

class JsonOutput final : public WatchOutput {
public:
    void on_hello(const v1::Hello&) override {}
    void on_lidar(const v1::Lidar&) override {}
    void on_end() override {}

    void on_sweep(const device::CapturedSweep& captured, std::size_t) override {
        v1::LatestScan scan;
        api::to_message(captured, scan);
        write(api::to_json_line(scan));
    }

    void on_stats(const v1::StreamStats& stats) override { note_drops(stats); }
};

class TableOutput final : public WatchOutput {
public:
    void on_hello(const v1::Hello& hello) override {
        for (const auto& lidar : hello.lidars()) {
            rows_[lidar.number()].lidar = lidar;
        }
        print();
    }

    void on_lidar(const v1::Lidar& lidar) override {
        rows_[lidar.number()].lidar = lidar;
        print_if_due();
    }

    void on_sweep(const device::CapturedSweep& captured, std::size_t bytes) override {
        const auto row = std::ranges::find_if(rows_, [&](const auto& entry) {
            return entry.second.lidar.id() == captured.lidar;
        });
        if (row == rows_.end()) {
            return;
        }
        auto& [number, shown] = *row;
        shown.points = captured.sweep.samples.size();
        shown.hz = captured.sweep.rotation_hz();
        shown.bytes = bytes;
        shown.missed += shown.sequence != 0 ? captured.sequence - shown.sequence - 1 : 0;
        shown.sequence = captured.sequence;
        print_if_due();
    }

    void on_stats(const v1::StreamStats&) override {}  // the table counts the gaps itself

    void on_end() override {
        if (!rows_.empty()) {
            print();
        }
    }

private:
    struct Row {
        v1::Lidar lidar;
        std::size_t points{};
        double hz{};
        std::size_t bytes{};
        std::uint64_t sequence{};
        std::uint64_t missed{};
    };

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
        lines_ = rows_.size() + 1;
        write(text);
    }

    static std::string line(const Row& row) {
        auto text = fmt::format(
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
        return row.lidar.cause().empty() ? text : text + "  " + row.lidar.cause();
    }

    const bool terminal_ = isatty(STDOUT_FILENO) != 0;
    std::map<std::uint32_t, Row> rows_;
    Clock::time_point printed_at_{};
    std::size_t lines_{};
};

}  // namespace

void WatchOutput::write(const std::string& text) {
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    if (!written || std::fflush(stdout) != 0) {
        write_error_ = error_code(errno, boost::system::generic_category());
    }
}

std::unique_ptr<WatchOutput> make_csv_output() {
    return std::make_unique<CsvOutput>();
}

std::unique_ptr<WatchOutput> make_json_output() {
    return std::make_unique<JsonOutput>();
}

std::unique_ptr<WatchOutput> make_table_output() {
    return std::make_unique<TableOutput>();
}

}  // namespace sweepcast::cli
