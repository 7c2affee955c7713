#include "server/hub/outbox.hpp"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <array>
#include <utility>

namespace sweepcast::hub {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

asio::const_buffer buffer(std::span<const std::uint8_t> bytes) {
    return {bytes.data(), bytes.size()};
}

}  // namespace

Outbox::Outbox(tcp::socket socket, frame::Framing framing)
    : framing_(framing)
    , socket_(std::move(socket)) {
    error_code failed;
    socket_.non_blocking(true, failed);
    if (failed) {  // the client has gone already
        fail(failed);
    }
}

Outbox::~Outbox() {
    end_own(asio::error::operation_aborted);
}

void Outbox::set_up(
    MailboxLimits limits,
    TellMissed tell_missed,
    Attend attend,
    std::chrono::milliseconds between_news
) {
    mailbox_ = Mailbox(limits);
    tell_missed_ = tell_missed;
    attend_ = std::move(attend);
    between_news_ = between_news;
}

void Outbox::push_control(const frame::WireMessagePtr& message) {
    if (closed_) {
        return;
    }
    if (state_ == State::ready) {
        const auto bytes = message->framed(framing_);
        const auto sent = send(bytes);
        if (sent < bytes.size()) {
            keep_rest(message, bytes.after(sent));
        }
    } else if (state_ == State::blocked && !mailbox_.push_control(message)) {
        close("too many state messages are waiting: the client does not read");
    }
}

void Outbox::write(std::span<const std::uint8_t> bytes, Last last, Sent sent) {
    own_ = bytes;
    own_last_ = last;
    own_sent_ = std::move(sent);
    if (state_ == State::ready) {
        flush();
    } else if (state_ != State::blocked) {
        end_own(asio::error::broken_pipe);
    }
}

void Outbox::close(std::string reason) {
    if (!std::exchange(closed_, true)) {
        end_reason_ = std::move(reason);
        mailbox_.discard_frames();
        call_attendant();
    }
}

void Outbox::abort(error_code why) {
    fail(why);
    error_code ignored;  // nothing is to be saved
    socket_.close(ignored);
}

asio::awaitable<void> Outbox::run() {
    struct Leave {
        std::shared_ptr<Attendance> attendance;
        ~Leave() { *attendance = {}; }
    } const leave{attendance_};
    while (state_ == State::blocked || (state_ == State::ready && !closed_ && news())) {
        error_code woken;
        if (state_ == State::blocked) {
            co_await socket_.async_wait(
                tcp::socket::wait_write,
                asio::redirect_error(asio::use_awaitable, woken)
            );
        } else {  // what is new of its losses is not to be told yet
            asio::steady_timer pause(socket_.get_executor(), news_due());
            attendance_->pause = &pause;
            co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, woken));
            attendance_->pause = nullptr;
            woken = {};  // something else to do, and then it is found above
        }
        if (woken) {
            fail(woken);
        } else if (state_ == State::ready || state_ == State::blocked) {
            flush();
        }
    }
}

/// Sends a frame while nothing waits.
void Outbox::send_frame(const frame::WireMessagePtr& frame) {
    const auto bytes = frame->framed(framing_);
    const auto sent = send(bytes);
    if (sent == bytes.size()) {
        ++frames_sent_;
    } else if (sent > 0) {
        ++frames_sent_;
        keep_rest(frame, bytes.after(sent));
    } else if (state_ == State::ready) {
        mailbox_.push_frame(frame);
        block();
    }
}

void Outbox::keep_frame(const frame::WireMessagePtr& frame) {
    if (state_ == State::blocked && !closed_) {
        mailbox_.push_frame(frame);
    }
}

/// Gives the socket what it takes at once; how many bytes that is.
std::size_t Outbox::send(const frame::FramedBytes& bytes) {
    error_code failed;
    std::size_t sent = 0;
    if (bytes.tail.empty()) {
        sent = socket_.send(buffer(bytes.head), 0, failed);
    } else {
        const std::array pieces{buffer(bytes.head), buffer(bytes.tail)};
        sent = socket_.send(pieces, 0, failed);
    }
    if (failed && failed != asio::error::would_block) {
        fail(failed);
    }
    return sent;
}

void Outbox::keep_rest(const frame::WireMessagePtr& message, const frame::FramedBytes& rest) {
    if (state_ == State::ready) {
        current_ = message;
        rest_ = rest;
        block();
    }
}

/// Sends what waits until nothing does or the socket takes no more.
void Outbox::flush() {
    state_ = State::ready;
    while (state_ == State::ready && begin_next()) {
        rest_ = rest_.after(send(rest_));
        if (state_ != State::ready) {
            return;
        }
        if (rest_.size() > 0) {
            block();
        } else {
            end_current();
        }
    }
}

/// Chooses what to go on with; false if nothing waits.
bool Outbox::begin_next() {
    if (rest_.size() > 0) {
        return true;
    }
    if (!own_.empty()) {
        rest_ = {std::exchange(own_, {}), {}};
        return true;
    }
    if (news() && Clock::now() >= news_due()) {
        told_at_ = Clock::now();
        dropped_told_ = mailbox_.frames_dropped();
        begin(tell_missed_(counts()));
        return true;
    }
    if (auto control = mailbox_.take_control()) {
        begin(std::move(control));
        return true;
    }
    if (auto frame = mailbox_.take_frame()) {
        ++frames_sent_;
        begin(std::move(frame));
        return true;
    }
    return false;
}

void Outbox::begin(frame::WireMessagePtr message) {
    current_ = std::move(message);
    rest_ = current_->framed(framing_);
}

void Outbox::end_current() {
    const bool own = current_ == nullptr;
    current_.reset();
    if (own) {
        if (own_last_ == Last::yes) {
            state_ = State::silent;
            mailbox_.discard_frames();
        }
        end_own({});
    }
}

void Outbox::end_own(error_code failed) {
    own_ = {};
    if (const auto sent = std::exchange(own_sent_, nullptr)) {
        sent(failed);
    }
}

void Outbox::block() {
    state_ = State::blocked;
    call_attendant();
}

void Outbox::call_attendant() {
    if (attendance_->pause != nullptr) {
        attendance_->pause->cancel();
    } else if (attend_ && !std::exchange(attendance_->attended, true)) {
        attend_();
    }
}

void Outbox::fail(error_code why) {
    if (state_ == State::failed) {
        return;
    }
    state_ = State::failed;
    if (!closed_) {
        end_reason_ = why.message();
    }
    current_.reset();
    rest_ = {};
    mailbox_.discard_frames();
    end_own(why);
    if (attendance_->pause != nullptr) {
        attendance_->pause->cancel();
    }
}

}  // namespace sweepcast::hub
