#include "server/hub/mailbox.hpp"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <utility>

namespace sweepcast::hub {

namespace asio = boost::asio;

Mailbox::Mailbox(asio::any_io_executor executor, MailboxLimits limits)
    : limits_(limits)
    , arrived_(executor, asio::steady_timer::time_point::max()) {}

void Mailbox::push_frame(frame::WireMessagePtr frame) {
    if (closed_) {
        return;
    }
    const auto size = frame->delimited().size();
    while (!frames_.empty() &&
           (frames_.size() >= limits_.frames || frame_bytes_ + size > limits_.frame_bytes)) {
        drop_oldest();
    }
    frame_bytes_ += size;
    frames_.push_back(std::move(frame));
    arrived_.cancel();
}

void Mailbox::push_control(frame::WireMessagePtr message) {
    if (closed_) {
        return;
    }
    if (controls_.size() >= limits_.controls) {
        close("too many state messages are waiting: the client does not read");
        return;
    }
    controls_.push_back(std::move(message));
    arrived_.cancel();
}

void Mailbox::close(std::string reason) {
    if (!std::exchange(closed_, true)) {
        close_reason_ = std::move(reason);
        frames_.clear();
        frame_bytes_ = 0;
        arrived_.cancel();
    }
}

asio::awaitable<frame::WireMessagePtr> Mailbox::next() {
    while (controls_.empty() && frames_.empty() && !closed_) {
        boost::system::error_code
            woken;  // no deadline: a stream may be silent for as long as its lidars are
        co_await arrived_.async_wait(asio::redirect_error(asio::use_awaitable, woken));
    }
    if (!controls_.empty()) {
        auto message = std::move(controls_.front());
        controls_.pop_front();
        co_return message;
    }
    if (frames_.empty()) {
        co_return nullptr;
    }
    auto frame = std::move(frames_.front());
    frames_.pop_front();
    frame_bytes_ -= frame->delimited().size();
    ++counts_.frames_taken;
    co_return frame;
}

void Mailbox::drop_oldest() {
    frame_bytes_ -= frames_.front()->delimited().size();
    frames_.pop_front();
    ++counts_.frames_dropped;
}

}  // namespace sweepcast::hub
