// FrameEncoder: a sweep or a slice of one -> the bytes of a ServerMessage with its frame, once for
// all clients that want it so.
#pragma once

#include "server/frame/frame_content.hpp"
#include "server/frame/wire_message.hpp"

#include <memory>

namespace sweepcast::frame {

/// Encodes frame after frame; its memory, the compressor's included, is used again. One thread at a
/// time.
class FrameEncoder {
public:
    FrameEncoder();
    FrameEncoder(FrameEncoder&&) noexcept;
    FrameEncoder& operator=(FrameEncoder&&) noexcept;
    ~FrameEncoder();

    /// The frame of `content`, ready for both transports. A scan that compression would not make
    /// smaller stays as it is, and the frame says so.
    /// Throws std::length_error for more than max_samples, which no sweep assembler gives out.
    [[nodiscard]] WireMessagePtr encode(const FrameContent& content, const FrameFormat& format);

private:
    struct Workspace;
    std::unique_ptr<Workspace> workspace_;
};

}  // namespace sweepcast::frame
