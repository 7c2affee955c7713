// TransmitLine: the scanner's side of a UART. Bytes leave it at the baud rate and no sooner.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/virtual/motor.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace sweepcast::virtual_lidar {

/// What bytes on the line belong to.
enum class Payload : std::uint8_t {
    answer,       ///< a descriptor, a reply of one packet, boot text
    measurement,  ///< packets of a measurement stream
};

/// Which measurement stream bytes belong to, or arrive in the midst of.
struct StreamId {
    std::uint32_t number{};  ///< since the scanner was made, from 1; 0: none
    protocol::AnswerType answer{};
    bool operator==(const StreamId&) const = default;
};

/// Bytes of one kind, in their order on the line.
struct Transmitted {
    Payload payload{};
    std::vector<std::uint8_t> bytes;
    StreamId stream{};
};

/// A bounded queue of bytes and the time at which each has left.
class TransmitLine {
public:
    /// What the queue holds at most: 0.35 s at 115200 baud, more than any pause in which the
    /// process is merely not scheduled.
    static constexpr std::size_t capacity = 4096;

    /// A line of `baud` bits per second, ten bits a byte. `baud` > 0.
    explicit TransmitLine(std::uint32_t baud);

    /// Changes the speed, also for what is queued.
    void set_baud(std::uint32_t baud);

    /// Queues bytes that are there to be sent from `ready` on, behind those of the last push.
    /// Returns false, and queues nothing, if there is no room for all of them.
    bool push(
        Payload payload,
        std::span<const std::uint8_t> bytes,
        Moment ready,
        const StreamId& stream = {}
    );

    /// Appends to `out` what has left the line completely by `now` and was not taken before.
    void take(Moment now, std::vector<Transmitted>& out);

    /// Drops measurements that are still queued at `now`, all but the next `kept` bytes of the
    /// queue.
    void drop_measurements(Moment now, std::size_t kept);

    /// Whether part of an answer has not left by `now`.
    [[nodiscard]] bool is_answering(Moment now);

    /// When the next byte will have left; none if nothing is queued.
    [[nodiscard]] std::optional<Moment> next_byte() const;

private:
    struct Run {
        Payload payload{};
        Moment ready;
        std::size_t left{};
        StreamId stream;
    };
    void run_until(Moment now);

    std::chrono::nanoseconds byte_time_;
    Moment busy_until_{};
    std::deque<Run> runs_;
    std::deque<std::uint8_t> queue_;
    std::vector<Transmitted> sent_;
};

}  // namespace sweepcast::virtual_lidar
