// Mailbox: what waits for one subscriber. Bounded: frames drop oldest first and are counted,
// control messages are never dropped.
#pragma once

#include "server/frame/wire_message.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

namespace sweepcast::hub {

struct MailboxLimits {
    /// Most frames waiting; at least one.
    std::size_t frames{8};
    /// Most bytes of frames waiting; a single frame may exceed it.
    std::size_t frame_bytes{1 << 20};
    /// Most control messages waiting; one more closes the mailbox.
    std::size_t controls{256};
};

struct MailboxCounts {
    std::uint64_t frames_taken{};
    std::uint64_t frames_dropped{};
};

/// Belongs to one worker's thread; has one reader.
class Mailbox {
public:
    Mailbox(boost::asio::any_io_executor executor, MailboxLimits limits);

    /// Queues a frame, dropping the oldest ones if it would not fit.
    void push_frame(frame::WireMessagePtr frame);

    /// Queues a message that must not be lost; it overtakes the frames. If too many wait already,
    /// the mailbox closes.
    void push_control(frame::WireMessagePtr message);

    /// No more comes in; the reader gets the control messages still waiting, then null. The first
    /// reason given stays.
    void close(std::string reason);

    /// Waits for the next message, control messages first. Null once the mailbox is closed and no
    /// control message waits.
    boost::asio::awaitable<frame::WireMessagePtr> next();

    [[nodiscard]] const MailboxCounts& counts() const { return counts_; }
    [[nodiscard]] const std::string& close_reason() const { return close_reason_; }
    [[nodiscard]] std::size_t waiting_bytes() const { return frame_bytes_; }

private:
    void drop_oldest();

    MailboxLimits limits_;
    boost::asio::steady_timer arrived_;
    std::deque<frame::WireMessagePtr> controls_;
    std::deque<frame::WireMessagePtr> frames_;
    std::size_t frame_bytes_{};
    MailboxCounts counts_;
    bool closed_{};
    std::string close_reason_;
};

}  // namespace sweepcast::hub
