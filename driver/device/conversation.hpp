// Conversation: requests and their answers over a link, one at a time.
#pragma once

#include "driver/link/link.hpp"
#include "driver/protocol/descriptor_hunter.hpp"
#include "driver/protocol/request.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/awaitable.hpp>

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::device {

/// Speaks with one device. Every wait has a deadline; what was read beyond an answer is kept for
/// the next step.
class Conversation {
public:
    explicit Conversation(link::Link& link) : link_(link) {}

    [[nodiscard]] link::Link& link() { return link_; }

    /// Sends bytes that are no request. Errors: those of the link.
    boost::asio::awaitable<Result<void>> write(std::span<const std::uint8_t> bytes);

    /// Sends a request that has no answer.
    /// Errors: those of the link.
    boost::asio::awaitable<Result<void>> send(const protocol::Request& request);

    /// Ends a scan that may be running and reads until the line is silent, so that the next answer
    /// is not mistaken for scan data: STOP, then drop bytes until 20 ms have brought none, at most
    /// 200 ms (protocol.md 11.3). Errors: those of the link.
    boost::asio::awaitable<Result<void>> silence();

    /// Sends a request and returns the payload of its single answer.
    /// Errors: link::errc::timed_out if the answer is not there in time; those of the link.
    boost::asio::awaitable<Result<std::vector<std::uint8_t>>> ask(
        const protocol::Request& request,
        const protocol::Expectation& expected,
        std::chrono::milliseconds limit
    );

    /// Sends a request that starts a measurement stream and returns its descriptor.
    /// The bytes of the stream follow from read().
    /// Errors: link::errc::timed_out; those of the link.
    boost::asio::awaitable<Result<protocol::Descriptor>>
    open_stream(const protocol::Request& request, std::chrono::milliseconds limit);

    /// The next bytes of an open stream. Valid until the next call.
    /// Errors: link::errc::timed_out, link::errc::interrupted; those of the link.
    boost::asio::awaitable<Result<std::span<const std::uint8_t>>> read(
        std::chrono::steady_clock::time_point deadline
    );

private:
    boost::asio::awaitable<Result<protocol::Descriptor>>
    hunt(const protocol::Expectation& expected, std::chrono::steady_clock::time_point deadline);
    void keep(std::span<const std::uint8_t> rest) { unread_ = rest; }

    link::Link& link_;
    std::array<std::uint8_t, 4096> buffer_{};
    /// Bytes in buffer_ that a descriptor hunt read but did not use.
    std::span<const std::uint8_t> unread_;
};

}  // namespace sweepcast::device
