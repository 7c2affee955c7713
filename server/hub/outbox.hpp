// Outbox: the way out to one client. A message goes straight to the socket while the socket takes
// it, in one system call; what it does not take waits in a mailbox.
#pragma once

#include "server/frame/wire_message.hpp"
#include "server/hub/mailbox.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace sweepcast::hub {

struct OutboxCounts {
    std::uint64_t frames_sent{};
    std::uint64_t frames_dropped{};
};

/// Belongs to one worker's thread. Owns the client's socket, from which others may read. A message
/// that has begun to go out is always finished before the next one.
///
/// state    | meaning                  | a message that comes
/// ---------|--------------------------|---------------------
/// ready    | nothing waits            | is sent
/// blocked  | the socket takes no more | waits
/// silent   | the last bytes are out   | is forgotten
/// failed   | the connection is broken | is forgotten
class Outbox {
public:
    /// Makes the message that tells a client what it missed.
    using TellMissed = frame::WireMessagePtr (*)(const OutboxCounts&);
    /// Called once when bytes of the transport's own are out, or with why they will not be.
    using Sent = std::function<void(boost::system::error_code)>;
    /// Called when there is something to do that takes time: run() has to be started.
    using Attend = std::function<void()>;

    Outbox(boost::asio::ip::tcp::socket socket, frame::Framing framing);
    /// No run() may be under way.
    ~Outbox();
    Outbox(const Outbox&) = delete;
    Outbox& operator=(const Outbox&) = delete;

    /// How much may wait, what a client that missed frames is told, and who runs run(). Before the
    /// first message.
    void set_up(
        MailboxLimits limits,
        TellMissed tell_missed,
        Attend attend,
        std::chrono::milliseconds between_news = std::chrono::seconds(1)
    );

    /// Sends a frame. If it has to wait, it may be dropped for a later one.
    void push_frame(const frame::WireMessagePtr& frame) {
        if (state_ == State::ready && !closed_) [[likely]] {
            send_frame(frame);
        } else {
            keep_frame(frame);
        }
    }

    /// Forgets the frames that wait: they are not wanted any more, and do not count as dropped.
    void discard_frames() { mailbox_.discard_frames(); }

    /// Sends a message that must not be lost; it overtakes the frames that wait. If too many of
    /// them wait already, the outbox closes.
    void push_control(const frame::WireMessagePtr& message);

    /// Whether anything may follow.
    enum class Last : bool { no, yes };
    /// Sends bytes of the transport's own as they are, before any message that waits. They must
    /// stay until `sent` is called, which is not before this returns; one such write at a time.
    void write(std::span<const std::uint8_t> bytes, Last last, Sent sent);

    /// No more comes in, and the frames that wait are forgotten. The first reason given stays.
    void close(std::string reason);

    /// Sends what waits, as the client takes it, and tells the client what it missed, at most once
    /// in `between_news`. Ends when nothing waits any more, or the connection broke. One at a time,
    /// when asked for. It has no deadline, but the kernel's: a client that takes nothing is cut off
    /// (see set_stream_options).
    boost::asio::awaitable<void> run();

    /// Whether it was closed and all is out that came before.
    [[nodiscard]] bool is_finished() const { return closed_ && state_ == State::ready; }
    [[nodiscard]] bool failed() const { return state_ == State::failed; }
    /// Ends the connection at once.
    void abort(boost::system::error_code why);
    /// Why it ended: the reason given, or how the connection broke.
    [[nodiscard]] const std::string& end_reason() const { return end_reason_; }

    [[nodiscard]] OutboxCounts counts() const { return {frames_sent_, mailbox_.frames_dropped()}; }
    [[nodiscard]] std::size_t waiting_bytes() const { return mailbox_.waiting_bytes(); }
    [[nodiscard]] boost::asio::ip::tcp::socket& socket() { return socket_; }

private:
    enum class State : std::uint8_t { ready, blocked, silent, failed };
    using Clock = std::chrono::steady_clock;

    void send_frame(const frame::WireMessagePtr& frame);
    void keep_frame(const frame::WireMessagePtr& frame);
    std::size_t send(const frame::FramedBytes& bytes);
    void keep_rest(const frame::WireMessagePtr& message, const frame::FramedBytes& rest);
    void flush();
    bool begin_next();
    void begin(frame::WireMessagePtr message);
    void end_current();
    void end_own(boost::system::error_code failed);
    void block();
    void call_attendant();
    void fail(boost::system::error_code why);
    [[nodiscard]] bool news() const { return mailbox_.frames_dropped() != dropped_told_; }
    /// Returns when the next losses may be reported; the first ones at once.
    [[nodiscard]] Clock::time_point news_due() const {
        return told_at_ ? *told_at_ + between_news_ : Clock::time_point::min();
    }

    State state_{State::ready};
    bool closed_{};
    frame::Framing framing_;
    Last own_last_{Last::no};
    std::uint64_t frames_sent_{};
    boost::asio::ip::tcp::socket socket_;

    /// The message that has begun to go out; null if none has, or bytes of the transport's own.
    frame::WireMessagePtr current_;
    /// What is still to be sent of it.
    frame::FramedBytes rest_;
    /// Bytes of the transport's own that have not begun to go out.
    std::span<const std::uint8_t> own_;
    Sent own_sent_;
    Mailbox mailbox_{MailboxLimits{}};
    TellMissed tell_missed_{};
    std::chrono::milliseconds between_news_{};
    std::uint64_t dropped_told_{};
    std::optional<Clock::time_point> told_at_;  ///< when losses were last reported
    Attend attend_;
    /// What is known of run(). It has a share of it: where contexts are torn down with coroutines
    /// still in them, it may be the last to go.
    struct Attendance {
        bool attended{};
        boost::asio::steady_timer* pause{};  ///< what it waits for, if for that
    };
    std::shared_ptr<Attendance> attendance_{std::make_shared<Attendance>()};
    std::string end_reason_;
};

}  // namespace sweepcast::hub
