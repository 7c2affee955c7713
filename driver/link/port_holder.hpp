// Which processes have a port open: for telling an operator which one to stop.
#pragma once

#include <filesystem>
#include <string>
#include <sys/types.h>
#include <vector>

namespace sweepcast::link {

struct PortHolder {
    pid_t pid{};
    std::string command;  ///< its short name, made printable
    /// `port` is a pseudo-terminal, and the process has its other end (the master) open too. So it
    /// plays the device, and keeps this end open so that the device outlives its hosts. It does not
    /// compete for the bytes.
    bool is_emulator{};
    bool operator==(const PortHolder&) const = default;
};

/// Returns the processes that have `port` open, by rising pid. Only those that we may look into:
/// without root, our own user's. Walks all of `proc`, some milliseconds' work or more: not on a
/// worker's thread.
std::vector<PortHolder>
find_port_holders(const std::string& port, const std::filesystem::path& proc = "/proc");

/// Returns those holders that compete for the port's bytes: all but emulators.
std::vector<PortHolder>
find_port_competitors(const std::string& port, const std::filesystem::path& proc = "/proc");

}  // namespace sweepcast::link
