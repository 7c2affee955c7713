#include "server/cli/capture_progress.hpp"

#include "server/cli/print.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <unistd.h>
#include <utility>

namespace sweepcast::cli {

namespace {

using Clock = std::chrono::steady_clock;

std::string shown(const std::string& path) {
    return path == "-" ? "standard output" : path;
}

}  // namespace

std::string to_text(const CaptureTotals& totals) {
    return fmt::format(
        "{:.1f} s, {} bytes, {} sweeps, {} checksum errors, {} bytes skipped, {} packets lost",
        totals.length.count(),
        totals.bytes,
        totals.sweeps,
        totals.line.checksum_errors,
        totals.line.skipped_bytes,
        totals.line.lost_packets
    );
}

void CaptureProgress::begin(const capture::CaptureHeader& header, const std::string& path) const {
    print(
        stderr,
        "sweepcast: capturing {} {} in mode {} {} to {}; Ctrl-C ends it\n",
        header.model,
        header.serial.substr(0, 8),
        header.mode,
        header.baud > 0 ? fmt::format("at {} baud", header.baud) : "over the network",
        shown(path)
    );
}

void CaptureProgress::update(const CaptureTotals& totals) {
    constexpr auto interval = std::chrono::milliseconds(200);
    const auto now = Clock::now();
    if (::isatty(STDERR_FILENO) == 0 || now - printed_at_ < interval) {
        return;
    }
    printed_at_ = now;
    shown_ = true;
    print(stderr, "\r\x1b[K{}", to_text(totals));
}

void CaptureProgress::clear() {
    if (std::exchange(shown_, false)) {
        print(stderr, "\r\x1b[K");
    }
}

void CaptureProgress::end(const CaptureTotals& totals, const std::string& path) {
    clear();
    print(stderr, "sweepcast: {}, in {}\n", to_text(totals), shown(path));
}

}  // namespace sweepcast::cli
