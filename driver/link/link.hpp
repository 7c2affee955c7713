// Link: a byte stream to a device, with deadlines. The driver's only way to the outside.
#pragma once

#include "driver/link/error.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sweepcast::link {

/// The moment an operation gives up; time_point::max() for never.
using Deadline = std::chrono::steady_clock::time_point;

/// A byte stream to a device. Everything is called on the thread of the executor it was made with.
/// At most one read and one write are pending at a time; they may overlap.
/// A link outlives its pending operations: end them with interrupt() or close() first.
class Link {
public:
    Link() = default;
    Link(const Link&) = delete;
    Link& operator=(const Link&) = delete;
    virtual ~Link() = default;

    /// Waits for bytes and gives how many were put at the front of `into` (at least one, unless
    /// `into` is empty). Bytes that arrive at the very moment of the deadline, of an interrupt or
    /// of a cancellation are delivered, never lost.
    /// Errors: errc::timed_out, errc::interrupted (also if the coroutine was cancelled meanwhile),
    /// errc::disconnected, or else the system's own code.
    [[nodiscard]] virtual boost::asio::awaitable<Result<std::size_t>>
    read_some(std::span<std::uint8_t> into, Deadline deadline) = 0;

    /// Writes all of `bytes`. After an error some of them may have been sent.
    /// Errors: as read_some.
    [[nodiscard]] virtual boost::asio::awaitable<Result<void>>
    write_all(std::span<const std::uint8_t> bytes, Deadline deadline) = 0;

    /// Ends the pending read with errc::interrupted; if none is pending, the next one ends so at
    /// once. No wake-up is lost: if a pending read completes with bytes at this moment, the read
    /// after it is the one interrupted. Writes are short and go on: half a request helps nobody.
    virtual void interrupt() = 0;

    /// Asserts or releases DTR, which on an A1 is the motor: it runs while DTR is released
    /// (protocol.md 5).
    /// Errors: errc::no_modem_lines, errc::disconnected, or else the system's own code.
    virtual Result<void> set_dtr(bool asserted) = 0;

    /// Changes the speed of the line to `baud` bits per second. The port stays open, so that DTR
    /// keeps its state; what arrived at the old speed and was not read yet is thrown away. What was
    /// just written may still be on its way and is then sent at the new speed: await its answer
    /// first.
    /// Errors: errc::no_line_speed on a network link, errc::baud_not_supported (the speed is the
    /// old one then), errc::disconnected, or else the system's own code.
    virtual Result<void> set_baud(std::uint32_t baud) = 0;

    /// Throws away what has arrived and was not read yet. Returns at once.
    virtual void flush_input() = 0;

    /// Line speed in bits per second, for the timing of samples; 0 on a network link.
    [[nodiscard]] virtual std::uint32_t baud() const = 0;

    /// Whether bytes come over a network: no line speed, no modem lines, times that jitter more.
    [[nodiscard]] virtual bool is_network() const = 0;

    /// Gives the port back. Pending operations end with errc::interrupted, later ones with
    /// errc::disconnected. Closing twice is harmless.
    virtual void close() = 0;
};

}  // namespace sweepcast::link
