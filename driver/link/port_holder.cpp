// Looks through the open files of all processes.
#include "driver/link/port_holder.hpp"

#include "driver/link/small_file.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

namespace sweepcast::link {

namespace fs = std::filesystem;

namespace {

std::optional<pid_t> parse_pid(const std::string& name) {
    pid_t pid{};
    const auto [end, ec] = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (ec != std::errc{} || end != name.data() + name.size() || pid <= 0) {
        return std::nullopt;
    }
    return pid;
}

/// Compares names and does not look at the files themselves: looking at one on a dead network drive
/// can hang.
bool has_open(const fs::path& process, const fs::path& file) {
    std::error_code ec;
    for (fs::directory_iterator fd(process / "fd", ec), end; !ec && fd != end; fd.increment(ec)) {
        std::error_code closed_meanwhile;
        if (fs::read_symlink(fd->path(), closed_meanwhile) == file && !closed_meanwhile) {
            return true;
        }
    }
    return false;
}

}  // namespace

std::vector<PortHolder> find_port_holders(const std::string& port, const fs::path& proc) {
    std::vector<PortHolder> holders;
    std::error_code ec;
    const fs::path file = fs::canonical(port, ec);  // by-id names are links
    if (ec) {
        return holders;
    }
    for (fs::directory_iterator entry(proc, ec), end; !ec && entry != end; entry.increment(ec)) {
        const auto pid = parse_pid(entry->path().filename().string());
        if (pid && has_open(entry->path(), file)) {
            holders.push_back({*pid, read_line(entry->path() / "comm")});
        }
    }
    std::sort(holders.begin(), holders.end(), [](const PortHolder& a, const PortHolder& b) {
        return a.pid < b.pid;
    });
    return holders;
}

}  // namespace sweepcast::link
