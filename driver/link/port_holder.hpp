// Who has a port open: for telling an operator which process to stop.
#pragma once

#include <filesystem>
#include <string>
#include <sys/types.h>
#include <vector>

namespace sweepcast::link {

struct PortHolder {
    pid_t pid{};
    std::string command;  ///< its short name, made printable
    bool operator==(const PortHolder&) const = default;
};

/// The processes that have `port` open, by rising pid. Only those that we may look into: without
/// root, our own user's. Walks all of `proc`, some milliseconds' work or more: not on a worker's
/// thread.
std::vector<PortHolder>
find_port_holders(const std::string& port, const std::filesystem::path& proc = "/proc");

}  // namespace sweepcast::link
