// LidarMemory: what the gateway remembers of lidars from one run to the next: at which line speed
// each one spoke, where, and which port its user calls it by.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace sweepcast::gateway {

/// A lidar of an earlier run.
struct RememberedLidar {
    std::string serial;
    std::uint32_t baud{};
    bool operator==(const RememberedLidar&) const = default;
};

/// A small JSON file. What is in it are hints: a file that is missing, damaged or out of date costs
/// nothing but the time to look at other speeds. Safe from any thread.
class LidarMemory {
public:
    /// Remembers nothing, and forgets at once.
    LidarMemory() = default;

    /// Reads `file`, if it is there. The Problem says why what was known cannot be used; it is
    /// begun anew then.
    Result<void, Problem> open(std::filesystem::path file);

    /// Line speeds to try first at `port`: that of the lidar last met there, that of the one named
    /// by it, then those of all others known, the most frequent first.
    [[nodiscard]] std::vector<std::uint32_t> baud_hints(const std::string& port) const;

    /// The lidar that a user who names `port` had there last, wherever it was met since.
    [[nodiscard]] std::optional<RememberedLidar> lidar_named_by(const std::string& port) const;

    /// The lidar of that serial number answered at `baud` on `port`. `home` is the port by which
    /// its user names it, empty if nobody did. Writes the file if this is news; the Problem says
    /// why it could not be written. A pseudo terminal's own path (/dev/pts/5) names nothing: in the
    /// next run that is somebody else's.
    Result<void, Problem> note(
        const std::string& serial,
        const std::string& port,
        std::uint32_t baud,
        const std::string& home = ""
    );

private:
    struct Entry {
        std::string port;
        std::uint32_t baud{};
        std::string home{};
        bool operator==(const Entry&) const = default;
    };

    std::string settle_home(const std::string& serial, const std::string& home);
    [[nodiscard]] Result<void, Problem> write() const;

    mutable std::mutex mutex_;
    std::filesystem::path file_;                ///< empty: nothing is written
    std::map<std::string, Entry> lidars_;       ///< by serial number
    std::map<std::string, std::string> homes_;  ///< noted in this run; empty: two of one number
};

/// Where the memory is kept unless told otherwise: "lidars.json" in $STATE_DIRECTORY (as systemd
/// sets it), else in $XDG_STATE_HOME/sweepcast, else in $HOME/.local/state/sweepcast; empty if none
/// of them is set.
[[nodiscard]] std::filesystem::path default_memory_file();

}  // namespace sweepcast::gateway
