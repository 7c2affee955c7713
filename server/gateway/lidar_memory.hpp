// LidarMemory: what the gateway remembers of lidars from one run to the next: at which line speed
// each one spoke, and where.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace sweepcast::gateway {

/// A small JSON file. What is in it are hints: a file that is missing, damaged or out of date costs
/// nothing but the time to look at other speeds. Safe from any thread.
class LidarMemory {
public:
    /// Remembers nothing, and forgets at once.
    LidarMemory() = default;

    /// Reads `file`, if it is there. The Problem says why what was known cannot be used; it is
    /// begun anew then.
    Result<void, Problem> open(std::filesystem::path file);

    /// Line speeds to try first at `port`: that of the lidar last met there, then those of all
    /// others known, the most frequent first.
    [[nodiscard]] std::vector<std::uint32_t> baud_hints(const std::string& port) const;

    /// The lidar of that serial number answered at `baud` on `port`. Writes the file if this is
    /// news; the Problem says why it could not be written.
    Result<void, Problem>
    note(const std::string& serial, const std::string& port, std::uint32_t baud);

private:
    struct Entry {
        std::string port;
        std::uint32_t baud{};
        bool operator==(const Entry&) const = default;
    };

    [[nodiscard]] Result<void, Problem> write() const;

    mutable std::mutex mutex_;
    std::filesystem::path file_;           ///< empty: nothing is written
    std::map<std::string, Entry> lidars_;  ///< by serial number
};

/// Where the memory is kept unless told otherwise: "lidars.json" in $STATE_DIRECTORY (as systemd
/// sets it), else in $XDG_STATE_HOME/sweepcast, else in $HOME/.local/state/sweepcast; empty if none
/// of them is set.
[[nodiscard]] std::filesystem::path default_memory_file();

}  // namespace sweepcast::gateway
