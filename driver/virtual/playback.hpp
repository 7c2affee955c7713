// Playback: a captured scan, played again bit for bit.
#pragma once

#include "driver/capture/capture_reader.hpp"
#include "driver/capture/stream_finder.hpp"
#include "driver/protocol/result.hpp"
#include "driver/virtual/motor.hpp"
#include "driver/virtual/persona.hpp"

#include <cstddef>
#include <cstdint>
#include <istream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::virtual_lidar {

/// The first measurement stream of a capture, and the scanner that it is of. The capture is read
/// as it is played, so its length does not matter.
class Playback {
public:
    /// What a piece holds at most: little enough to find room on the line.
    static constexpr std::size_t max_piece = 1024;

    /// `capture` can be read again from its beginning; `name` is how problems call it. With `loop`
    /// it begins again when it has ended. Errors: errc::capture_unusable.
    static Result<std::unique_ptr<Playback>, Problem>
    open(std::unique_ptr<std::istream> capture, std::string_view name, bool loop);

    /// As open(), of a file.
    static Result<std::unique_ptr<Playback>, Problem> load(const std::string& path, bool loop);

    Playback(const Playback&) = delete;
    Playback& operator=(const Playback&) = delete;

    /// The scanner that was captured, as far as the capture tells; the rest is that of the persona
    /// most like it. Its typical mode is the captured one.
    [[nodiscard]] const Persona& persona() const { return persona_; }
    [[nodiscard]] const SerialNumber& serial() const { return serial_; }
    [[nodiscard]] const ScanMode& mode() const { return modes_[persona_.typical_mode]; }

    struct Piece {
        Moment ready;  ///< its first byte leaves then, to have arrived as the captured one had
        std::span<const std::uint8_t> bytes;
    };

    /// From the beginning; the answer to the scan request leaves at `now`, on a line of `baud`.
    void start(Moment now, std::uint32_t baud);

    /// What comes next; none at the end. Valid until the next pop() or start().
    [[nodiscard]] std::optional<Piece> piece() const;

    /// Goes on to what comes after that.
    void pop();

private:
    Playback(std::unique_ptr<std::istream> capture, bool loop);
    void adopt(const capture::CaptureHeader& header);
    bool rewind();
    bool read_block();
    void refill();

    std::unique_ptr<std::istream> capture_;
    bool loop_;
    std::optional<capture::CaptureReader> reader_;
    capture::StreamFinder finder_;
    protocol::AnswerType type_{};
    std::string title_, alias_, mode_name_;
    std::vector<ScanMode> modes_;
    Persona persona_;
    SerialNumber serial_{};

    Moment origin_;  // the descriptor's time
    std::chrono::nanoseconds descriptor_at_{};
    std::chrono::nanoseconds last_at_{};
    std::chrono::nanoseconds byte_time_{};
    std::vector<std::uint8_t> block_;  // the rest of what arrived together
    std::size_t played_{};             // of it
};

}  // namespace sweepcast::virtual_lidar
