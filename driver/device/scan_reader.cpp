#include "driver/device/scan_reader.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

namespace sweepcast::device {

namespace {

/// Ten bits a byte; a network's blocks arrive all at once.
std::chrono::nanoseconds time_of_byte(std::uint32_t baud) {
    return std::chrono::nanoseconds(baud > 0 ? 10'000'000'000LL / baud : 0);
}

std::uint32_t to_q2(double millimetres) {
    constexpr double most = std::numeric_limits<std::uint32_t>::max();
    return static_cast<std::uint32_t>(std::clamp(millimetres * 4.0, 0.0, most));
}

}  // namespace

Result<ScanReader> ScanReader::create(
    protocol::AnswerType type,
    const ScanMode& mode,
    std::uint32_t baud,
    LineQuality& line
) {
    auto decoder = protocol::Decoder::create(type, {mode.sample_duration, baud, baud == 0});
    if (!decoder) {
        return decoder.error();
    }
    const protocol::SampleClock clock({type, mode.sample_duration, time_of_byte(baud)});
    return ScanReader(std::move(*decoder), clock, mode.max_distance_mm, baud, line);
}

ScanReader::ScanReader(
    protocol::Decoder decoder,
    protocol::SampleClock clock,
    double max_distance_mm,
    std::uint32_t baud,
    LineQuality& line
)
    : decoder_(std::move(decoder))
    , clock_(std::move(clock))
    , per_byte_(time_of_byte(baud))
    , max_distance_q2_(
          max_distance_mm > 0 ? to_q2(max_distance_mm) : std::numeric_limits<std::uint32_t>::max()
      )
    , line_(&line) {}

std::size_t ScanReader::push(
    std::span<const std::uint8_t> bytes,
    protocol::SampleTime now,
    std::vector<protocol::Sweep>& finished
) {
    decoded_.clear();
    decoder_.push(bytes, {now, per_byte_}, decoded_);
    clock_.retime(decoded_, bytes.size(), now);
    clip_range();
    account_for(bytes.size());
    assembler_.push(decoded_, finished);
    return decoded_.samples.size();
}

void ScanReader::clip_range() {
    for (auto& sample : decoded_.samples) {
        if (sample.distance.raw > max_distance_q2_) {
            sample.distance.raw = 0;
            sample.quality = 0;
        }
    }
}

void ScanReader::account_for(std::size_t bytes) {
    line_->bytes += bytes;
    line_->samples += decoded_.samples.size();
    protocol::LineLosses losses;
    for (const auto& event : decoded_.events) {
        losses.count(event);
    }
    line_->checksum_errors += losses.checksum_errors;
    line_->skipped_bytes += losses.skipped_bytes;
    line_->lost_packets += losses.lost_packets;
}

}  // namespace sweepcast::device
