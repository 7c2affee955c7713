// CaptureWriter: writes a capture, so that what was written survives the program.
#pragma once

#include "driver/capture/capture_header.hpp"
#include "driver/capture/capture_record.hpp"

#include <chrono>
#include <iosfwd>
#include <span>

namespace sweepcast::capture {

class CaptureWriter {
public:
    /// Begins the file in `out`, which outlives this; ok() tells whether that worked.
    CaptureWriter(std::ostream& out, const CaptureHeader& header);

    /// Appends bytes as they came or went at `at`, in several records if they are many; a time
    /// before the last one is taken as the last one. They are handed to the system when it returns.
    /// False if that failed (the disk is full): what follows would have a hole before it, so
    /// nothing more is written.
    bool
    append(Direction direction, std::chrono::nanoseconds at, std::span<const std::uint8_t> bytes);

    /// Whether all that was appended was written.
    [[nodiscard]] bool ok() const;

private:
    void write(std::span<const std::uint8_t> bytes);

    std::ostream* out_;
    std::chrono::nanoseconds last_{};
};

}  // namespace sweepcast::capture
