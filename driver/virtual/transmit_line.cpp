#include "driver/virtual/transmit_line.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace {

// Rounded up, so that the line is never faster than its baud rate.
std::chrono::nanoseconds time_of_byte(std::uint32_t baud) {
    constexpr std::uint64_t ten_bits_ns = 10'000'000'000U;
    return std::chrono::nanoseconds((ten_bits_ns + baud - 1U) / baud);
}

}  // namespace

TransmitLine::TransmitLine(std::uint32_t baud) : byte_time_(time_of_byte(baud)) {}

void TransmitLine::set_baud(std::uint32_t baud) {
    byte_time_ = time_of_byte(baud);
}

bool TransmitLine::push(
    Payload payload,
    std::span<const std::uint8_t> bytes,
    Moment ready,
    const StreamId& stream
) {
    run_until(ready);
    if (bytes.size() > capacity - queue_.size()) {
        return false;
    }
    if (bytes.empty()) {
        return true;
    }
    queue_.insert(queue_.end(), bytes.begin(), bytes.end());
    runs_.push_back({payload, ready, bytes.size(), stream});
    return true;
}

void TransmitLine::take(Moment now, std::vector<Transmitted>& out) {
    run_until(now);
    std::move(sent_.begin(), sent_.end(), std::back_inserter(out));
    sent_.clear();
}

void TransmitLine::drop_measurements(Moment now, std::size_t kept) {
    run_until(now);
    while (!runs_.empty() && runs_.back().payload == Payload::measurement && queue_.size() > kept) {
        auto& last = runs_.back();
        const auto dropped = std::min(queue_.size() - kept, last.left);
        queue_.erase(std::prev(queue_.end(), static_cast<std::ptrdiff_t>(dropped)), queue_.end());
        last.left -= dropped;
        if (last.left == 0) {
            runs_.pop_back();
        }
    }
}

bool TransmitLine::is_answering(Moment now) {
    run_until(now);
    return std::any_of(runs_.begin(), runs_.end(), [](const Run& run) {
        return run.payload == Payload::answer;
    });
}

std::optional<Moment> TransmitLine::next_byte() const {
    if (runs_.empty()) {
        return std::nullopt;
    }
    return std::max(busy_until_, runs_.front().ready) + byte_time_;
}

void TransmitLine::run_until(Moment now) {
    while (!runs_.empty()) {
        auto& run = runs_.front();
        const auto start = std::max(busy_until_, run.ready);
        if (now < start + byte_time_) {
            return;
        }
        const auto count = std::min(static_cast<std::size_t>((now - start) / byte_time_), run.left);
        const auto end = std::next(queue_.begin(), static_cast<std::ptrdiff_t>(count));
        if (sent_.empty() || sent_.back().payload != run.payload ||
            sent_.back().stream != run.stream) {
            sent_.push_back({run.payload, {}, run.stream});
        }
        sent_.back().bytes.insert(sent_.back().bytes.end(), queue_.begin(), end);
        queue_.erase(queue_.begin(), end);
        busy_until_ = start + byte_time_ * static_cast<std::int64_t>(count);
        run.left -= count;
        if (run.left == 0) {
            runs_.pop_front();
        }
    }
}

}  // namespace sweepcast::virtual_lidar
