// FrameDecoder: a Frame message -> the scan in it. For clients, recordings and tests; the frame is
// hostile.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/frame/scan_columns.hpp"

#include <cstdint>
#include <memory>

namespace sweepcast::v1 {
class Frame;
}

namespace sweepcast::frame {

/// The most bytes of a scan before compression. A full one of max_samples has at most 21 bytes a
/// sample.
constexpr std::uint32_t max_raw_size = 2 * 1024 * 1024;

/// Decodes frame after frame; its memory is used again. One thread at a time.
class FrameDecoder {
public:
    FrameDecoder();
    FrameDecoder(FrameDecoder&&) noexcept;
    FrameDecoder& operator=(FrameDecoder&&) noexcept;
    ~FrameDecoder();

    /// The scan in `frame`. The announced size is checked, against the limit and against what the
    /// compressed body says of itself, before memory is taken for it. Errors:
    /// errc::compression_unknown, dictionary_unknown, raw_size_out_of_range, raw_size_wrong,
    /// compression_damaged, scan_malformed, and those of from_columns.
    Result<DecodedScan> decode(const v1::Frame& frame);

private:
    struct Workspace;
    std::unique_ptr<Workspace> workspace_;
};

}  // namespace sweepcast::frame
