// Recording: the measurement bytes that hosts were sent, to compare with what came out at the far
// end.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstdint>
#include <fstream>
#include <span>
#include <string>

namespace sweepcast::virtual_lidar {

/// A file of raw measurement bytes: what followed the descriptors of measurement streams, byte for
/// byte, streams one after the other, nothing else. A stream that was stopped may end inside a
/// packet. To tell streams apart, record one at a time.
class Recording {
public:
    /// Begins a new file, in place of what was there.
    /// Errors: errc::recording_unavailable.
    static Result<Recording, Problem> create(const std::string& path);

    /// Appends bytes; they are in the file when it returns. False if that failed (the disk is
    /// full): the recording is then of no more use.
    bool append(std::span<const std::uint8_t> bytes);

private:
    explicit Recording(std::ofstream file) : file_(std::move(file)) {}
    std::ofstream file_;
};

}  // namespace sweepcast::virtual_lidar
