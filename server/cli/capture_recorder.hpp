// CaptureRecorder: what passes over a link -> a capture with times of its own.
#pragma once

#include "driver/capture/capture_header.hpp"
#include "driver/capture/capture_record.hpp"
#include "driver/capture/capture_writer.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <vector>

namespace sweepcast::cli {

/// A capture begins with a header that tells of the lidar, which is known only after it was asked.
/// So what is said until then is kept, and comes first in the file.
class CaptureRecorder {
public:
    using Moment = std::chrono::steady_clock::time_point;

    /// How many bytes are kept before there is a file: a lidar tells who it is in a few hundred.
    static constexpr std::size_t most_kept_bytes = 4 << 20;

    /// Takes bytes that passed at `now`; the first ones begin the capture. False if they could not
    /// be kept or written: then nothing more is.
    bool record(capture::Direction direction, Moment now, std::span<const std::uint8_t> bytes);

    /// Forgets what was kept, if there is no file yet: it was said at a line speed that was wrong.
    void forget();

    /// Begins the file in `out`, which outlives this. `header.started` is filled in. False if the
    /// beginning could not be written.
    bool begin(std::ostream& out, capture::CaptureHeader header);

    [[nodiscard]] bool ok() const;
    /// That came from the device and were kept or written.
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

private:
    std::optional<capture::CaptureWriter> writer_;
    std::vector<capture::CaptureRecord> kept_;
    std::size_t kept_bytes_{};
    bool overflowed_{};
    std::optional<Moment> began_;
    std::chrono::system_clock::time_point began_at_{};
    std::uint64_t bytes_{};
};

}  // namespace sweepcast::cli
