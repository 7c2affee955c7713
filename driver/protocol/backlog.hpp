// Backlog: lets a decoder see packets whole although reads cut the stream anywhere.
#pragma once

#include "driver/protocol/decoded.hpp"
#include "driver/protocol/units.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sweepcast::protocol {

/// Consecutive bytes of a stream, each with the time it arrived.
class TimedBytes {
public:
    /// A block as read: times follow from the arrival of its last byte.
    TimedBytes(std::span<const std::uint8_t> bytes, const Arrival& arrival)
        : bytes_(bytes)
        , arrival_(arrival) {}
    /// Bytes kept from several blocks, with as many times.
    TimedBytes(std::span<const std::uint8_t> bytes, std::span<const ExactTime> times)
        : bytes_(bytes)
        , times_(times) {}

    [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }

    /// When byte `index` arrived.
    [[nodiscard]] ExactTime byte_time(std::size_t index) const {
        return times_.empty() ? time_in_block(index) : times_[index];
    }

    /// The same in whole microseconds, rounded down.
    [[nodiscard]] SampleTime arrival_of(std::size_t index) const {
        return to_sample_time(byte_time(index));
    }

    /// What follows the first `count` bytes.
    [[nodiscard]] TimedBytes after(std::size_t count) const {
        auto rest = *this;
        rest.bytes_ = bytes_.subspan(count);
        rest.times_ = times_.empty() ? times_ : times_.subspan(count);
        return rest;
    }

private:
    [[nodiscard]] ExactTime time_in_block(std::size_t index) const {
        const auto later = static_cast<std::int64_t>(bytes_.size() - 1 - index);
        return arrival_.last_byte - later * arrival_.per_byte;
    }

    std::span<const std::uint8_t> bytes_;
    std::span<const ExactTime> times_;
    Arrival arrival_;
};

/// Keeps the bytes that a decoder could not use yet, at most `Capacity`, and shows them to it again
/// in front of the next block. Whole packets inside a block are decoded where they lie.
///
/// A decoder is a function `std::size_t step(const TimedBytes&)` that says how many bytes from the
/// front it has dealt with, or 0 if it needs to see more; it must not ask for more than `Capacity`.
template <std::size_t Capacity>
class Backlog {
public:
    /// Calls `step` until it has dealt with all of `bytes` that it can.
    template <class Step>
    void feed(std::span<const std::uint8_t> bytes, const Arrival& arrival, Step&& step) {
        while (size_ > 0 && !bytes.empty()) {
            const auto old = size_;
            const auto taken = append(bytes, arrival);
            const auto used = exhaust(kept(), step);
            if (used >= old) {
                bytes = bytes.subspan(used - old);
                size_ = 0;
            } else {
                bytes = bytes.subspan(taken);
                drop_first(used);
            }
        }
        if (size_ == 0) {
            const auto used = exhaust(TimedBytes{bytes, arrival}, step);
            append(bytes.subspan(used), arrival);
        }
    }

private:
    template <class Step>
    static std::size_t exhaust(const TimedBytes& bytes, Step& step) {
        std::size_t used = 0;
        while (const std::size_t dealt_with = step(bytes.after(used))) {
            used += dealt_with;
        }
        return used;
    }

    [[nodiscard]] TimedBytes kept() const {
        return {std::span(bytes_).first(size_), std::span(times_).first(size_)};
    }

    std::size_t append(std::span<const std::uint8_t> bytes, const Arrival& arrival) {
        const auto taken = std::min(Capacity - size_, bytes.size());
        const TimedBytes timed{bytes, arrival};
        for (std::size_t i = 0; i < taken; ++i) {
            bytes_[size_ + i] = bytes[i];
            times_[size_ + i] = timed.byte_time(i);
        }
        size_ += taken;
        return taken;
    }

    void drop_first(std::size_t count) {
        std::copy(bytes_.begin() + count, bytes_.begin() + size_, bytes_.begin());
        std::copy(times_.begin() + count, times_.begin() + size_, times_.begin());
        size_ -= count;
    }

    std::array<std::uint8_t, Capacity> bytes_{};
    std::array<ExactTime, Capacity> times_{};
    std::size_t size_{};
};

}  // namespace sweepcast::protocol
