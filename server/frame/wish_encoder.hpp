// WishEncoder: a sweep or a slice of one -> the frame that a wish makes of it.
#pragma once

#include "server/frame/frame_content.hpp"
#include "server/frame/frame_encoder.hpp"
#include "server/frame/wire_message.hpp"
#include "server/frame/wish.hpp"

#include <cstddef>
#include <vector>

namespace sweepcast::frame {

/// Encodes frame after frame; its memory is used again. One thread at a time.
class WishEncoder {
public:
    /// The frame of `content`, whose samples are those of their sweep from number `first` on. Null
    /// if nothing is left of a slice that is not the last.
    [[nodiscard]] WireMessagePtr
    encode(FrameContent content, const Wish& wish, std::size_t first = 0);

private:
    FrameEncoder encoder_;
    std::vector<protocol::Sample> samples_;
};

}  // namespace sweepcast::frame
