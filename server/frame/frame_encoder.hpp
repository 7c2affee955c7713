// FrameEncoder: a sweep -> the bytes of a ServerMessage with its frame, once for all clients that
// want it so.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "server/frame/wire_message.hpp"

#include <cstdint>
#include <memory>

namespace sweepcast::frame {

/// What is done to the scan inside a frame.
enum class Compression : std::uint8_t { zstd, none };

/// Encodes sweep after sweep; its memory, the compressor's included, is used again. One thread at a
/// time.
class FrameEncoder {
public:
    FrameEncoder();
    FrameEncoder(FrameEncoder&&) noexcept;
    FrameEncoder& operator=(FrameEncoder&&) noexcept;
    ~FrameEncoder();

    /// The frame of `captured`, ready for both transports.
    /// Throws std::length_error for a sweep of more than max_samples, which no sweep assembler
    /// gives out.
    [[nodiscard]] WireMessagePtr
    encode(const device::CapturedSweep& captured, Compression compression);

private:
    struct Workspace;
    std::unique_ptr<Workspace> workspace_;
};

}  // namespace sweepcast::frame
