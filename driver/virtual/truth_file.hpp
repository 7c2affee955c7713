// TruthFile: the measurement packets as the scanner made them, to compare with what came out at the
// far end of a bad line.
#pragma once

#include "driver/protocol/result.hpp"
#include "driver/virtual/emulator.hpp"

#include <fstream>
#include <string>
#include <utility>

namespace sweepcast::virtual_lidar {

/// A text file, a line a packet: the stream's number, its answer type and the packet, the last two
/// in hex: "3 82 a55f...". Streams are numbered from 1; a line that begins with # is a comment.
class TruthFile {
public:
    /// Begins a new file, in place of what was there.
    /// Errors: errc::recording_unavailable.
    static Result<TruthFile, Problem> create(const std::string& path);

    /// Appends a packet. False if that failed (the disk is full).
    bool append(const Measured& measured);

    /// What was appended is in the file when it returns. False if that failed.
    bool flush() { return static_cast<bool>(file_.flush()); }

private:
    explicit TruthFile(std::ofstream file) : file_(std::move(file)) {}
    std::ofstream file_;
};

}  // namespace sweepcast::virtual_lidar
