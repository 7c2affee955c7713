#include "server/cli/capture_recorder.hpp"

#include <fmt/chrono.h>

#include <utility>

namespace sweepcast::cli {

namespace {

std::string utc_text(std::chrono::system_clock::time_point time) {
    const auto milliseconds =
        std::chrono::floor<std::chrono::milliseconds>(time.time_since_epoch()).count();
    const auto seconds = std::chrono::system_clock::to_time_t(time);
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(seconds), milliseconds % 1000);
}

}  // namespace

bool CaptureRecorder::record(
    capture::Direction direction,
    Moment now,
    std::span<const std::uint8_t> bytes
) {
    if (!began_) {
        began_ = now;
        began_at_ = std::chrono::system_clock::now();
    }
    const std::chrono::nanoseconds at = now - *began_;
    if (writer_) {
        writer_->append(direction, at, bytes);
    } else {
        overflowed_ = overflowed_ || bytes.size() > most_kept_bytes - kept_bytes_;
        if (!overflowed_) {
            kept_bytes_ += bytes.size();
            kept_.push_back({direction, at, {bytes.begin(), bytes.end()}});
        }
    }
    if (ok() && direction == capture::Direction::from_device) {
        bytes_ += bytes.size();
    }
    return ok();
}

void CaptureRecorder::forget() {
    if (!writer_) {
        *this = CaptureRecorder();
    }
}

bool CaptureRecorder::begin(std::ostream& out, capture::CaptureHeader header) {
    header.started = utc_text(began_ ? began_at_ : std::chrono::system_clock::now());
    writer_.emplace(out, header);
    for (const auto& record : std::exchange(kept_, {})) {
        writer_->append(record.direction, record.at, record.bytes);
    }
    return ok();
}

bool CaptureRecorder::ok() const {
    return writer_ ? writer_->ok() : !overflowed_;
}

}  // namespace sweepcast::cli
