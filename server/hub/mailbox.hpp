// Mailbox: what waits for one subscriber. Bounded: frames drop oldest first and are counted,
// control messages are never dropped.
#pragma once

#include "server/frame/wire_message.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sweepcast::hub {

struct MailboxLimits {
    /// Most frames waiting; at least one.
    std::size_t frames{8};
    /// Most bytes of frames waiting; a single frame may exceed it.
    std::size_t frame_bytes{1 << 20};
    /// Most control messages waiting.
    std::size_t controls{256};
};

/// Holds no memory while nothing waits.
class Mailbox {
public:
    explicit Mailbox(MailboxLimits limits) : limits_(limits) {}

    /// Queues a frame, dropping the oldest ones if it would not fit.
    void push_frame(frame::WireMessagePtr frame);

    /// Queues a message that must not be lost. False if too many wait already.
    [[nodiscard]] bool push_control(frame::WireMessagePtr message);

    /// The next control message; null if none waits.
    [[nodiscard]] frame::WireMessagePtr take_control() { return take(controls_); }
    /// The next frame; null if none waits.
    [[nodiscard]] frame::WireMessagePtr take_frame();

    /// Forgets the frames that wait; they do not count as dropped.
    void discard_frames();

    [[nodiscard]] std::uint64_t frames_dropped() const { return frames_dropped_; }
    [[nodiscard]] std::size_t waiting_bytes() const { return frame_bytes_; }

private:
    // Short, and empty nearly always: a deque would keep half a kilobyte each.
    using Queue = std::vector<frame::WireMessagePtr>;
    static frame::WireMessagePtr take(Queue& queue);

    MailboxLimits limits_;
    Queue controls_;
    Queue frames_;
    std::size_t frame_bytes_{};
    std::uint64_t frames_dropped_{};
};

}  // namespace sweepcast::hub
