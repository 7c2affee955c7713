// CaptureHeader: which device was captured, how it scanned, and when.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/result.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sweepcast::capture {

/// For people, but for the last lines: those are what decoding needs. A stream's own descriptor
/// tells its answer type.
struct CaptureHeader {
    std::string program{};  ///< that wrote it, e.g. "sweepcast 0.1.0"
    std::string started{};  ///< wall clock, e.g. "2026-01-31T12:00:00.000Z"
    std::string model{};    ///< e.g. "A1M8"
    std::uint8_t model_id{};
    std::string serial{};    ///< 32 hex digits
    std::string firmware{};  ///< e.g. "1.29"
    std::uint8_t hardware{};
    std::string mode{};  ///< name of the scan mode
    std::optional<std::uint16_t> mode_id{};
    protocol::AnswerType answer_type{};
    std::chrono::nanoseconds sample_duration{};  ///< 0 if not known
    std::uint32_t baud{};                        ///< bits per second; 0: a network
    bool operator==(const CaptureHeader&) const = default;
};

/// One line of JSON, without the line's end.
[[nodiscard]] std::string to_json(const CaptureHeader& header);

/// Reads such a line. Members that are not known are ignored; texts may be missing.
/// The Problem says what is wrong with it.
[[nodiscard]] Result<CaptureHeader, Problem> header_from_json(std::string_view text);

}  // namespace sweepcast::capture
