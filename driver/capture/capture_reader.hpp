// CaptureReader: gives the records of a capture in their order, whatever the file is.
#pragma once

#include "driver/capture/capture_header.hpp"
#include "driver/capture/capture_record.hpp"
#include "driver/protocol/result.hpp"

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string_view>

namespace sweepcast::capture {

class CaptureReader {
public:
    /// Reads the header from `in`, which outlives this.
    /// The Problem says that it is no capture, one of a later version, or one with a damaged
    /// header.
    static Result<CaptureReader, Problem> open(std::istream& in);

    [[nodiscard]] const CaptureHeader& header() const { return header_; }

    /// How the file ended.
    enum class End : std::uint8_t {
        not_yet,    ///< there may be more records
        whole,      ///< after a whole record
        cut_short,  ///< inside a record, of which nothing is given: its writer was stopped
        damaged,    ///< what comes next is no record; nothing is known of what follows
    };

    /// The next record; none at the end, which end() explains.
    std::optional<CaptureRecord> next();
    [[nodiscard]] End end() const { return end_; }

private:
    CaptureReader(std::istream& in, CaptureHeader header) : in_(&in), header_(std::move(header)) {}

    std::istream* in_;
    CaptureHeader header_;
    End end_{End::not_yet};
    std::chrono::nanoseconds last_{};
};

/// Whether a file that begins with `bytes` (at least magic.size() of them) is a capture.
[[nodiscard]] bool is_capture(std::string_view bytes);

}  // namespace sweepcast::capture
