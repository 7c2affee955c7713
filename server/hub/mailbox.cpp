#include "server/hub/mailbox.hpp"

#include <utility>

namespace sweepcast::hub {

void Mailbox::push_frame(frame::WireMessagePtr frame) {
    const auto size = frame->size();
    while (!frames_.empty() &&
           (frames_.size() >= limits_.frames || frame_bytes_ + size > limits_.frame_bytes)) {
        (void)take_frame();  // the oldest
        ++frames_dropped_;
    }
    frame_bytes_ += size;
    frames_.push_back(std::move(frame));
}

bool Mailbox::push_control(frame::WireMessagePtr message) {
    if (controls_.size() >= limits_.controls) {
        return false;
    }
    controls_.push_back(std::move(message));
    return true;
}

frame::WireMessagePtr Mailbox::take_frame() {
    auto frame = take(frames_);
    if (frame) {
        frame_bytes_ -= frame->size();
    }
    return frame;
}

void Mailbox::discard_frames() {
    frames_ = {};
    frame_bytes_ = 0;
}

frame::WireMessagePtr Mailbox::take(Queue& queue) {
    if (queue.empty()) {
        return nullptr;
    }
    auto first = std::move(queue.front());
    queue.erase(queue.begin());
    if (queue.empty()) {
        queue.shrink_to_fit();
    }
    return first;
}

}  // namespace sweepcast::hub
