// Looks through the open files of all processes.
#include "driver/link/port_holder.hpp"

#include "driver/link/small_file.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>

namespace sweepcast::link {

namespace fs = std::filesystem;

namespace {

template <class Number>
std::optional<Number> parse_number(std::string_view text) {
    Number number{};
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (ec != std::errc{} || end != text.data() + text.size()) {
        return std::nullopt;
    }
    return number;
}

std::optional<pid_t> parse_pid(const std::string& name) {
    const auto pid = parse_number<pid_t>(name);
    return pid && *pid > 0 ? pid : std::nullopt;
}

/// The number of a pseudo-terminal: 5 for "/dev/pts/5".
std::optional<std::uint32_t> pty_number(const fs::path& port) {
    return port.parent_path() == "/dev/pts" ? parse_number<std::uint32_t>(port.filename().native())
                                            : std::nullopt;
}

/// Whether a descriptor of /dev/ptmx is the master of pseudo-terminal `number`, as the kernel tells
/// in its fdinfo (since Linux 4.14).
bool is_master_of(const fs::path& fdinfo, std::uint32_t number) {
    constexpr std::string_view key = "tty-index:";
    std::ifstream file(fdinfo);
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with(key)) {
            const auto begins = line.find_first_not_of(" \t", key.size());
            return begins != std::string::npos &&
                   parse_number<std::uint32_t>(std::string_view(line).substr(begins)) == number;
        }
    }
    return false;
}

struct Ends {
    bool port{};
    bool master{};
};

/// Which ends of `port` a process has open. Compares names and does not look at the files
/// themselves: looking at one on a dead network drive can hang.
Ends open_ends(const fs::path& process, const fs::path& port) {
    const auto number = pty_number(port);
    Ends found;
    std::error_code ec;
    for (fs::directory_iterator fd(process / "fd", ec), end; !ec && fd != end; fd.increment(ec)) {
        std::error_code closed_meanwhile;
        const auto file = fs::read_symlink(fd->path(), closed_meanwhile);
        if (closed_meanwhile) {
            continue;
        }
        found.port = found.port || file == port;
        if (number && file.filename() == "ptmx") {
            found.master =
                found.master || is_master_of(process / "fdinfo" / fd->path().filename(), *number);
        }
        if (found.port && (found.master || !number)) {
            break;
        }
    }
    return found;
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
        if (!pid) {
            continue;
        }
        const auto open = open_ends(entry->path(), file);
        if (open.port) {
            holders.push_back({*pid, read_line(entry->path() / "comm"), open.master});
        }
    }
    std::sort(holders.begin(), holders.end(), [](const PortHolder& a, const PortHolder& b) {
        return a.pid < b.pid;
    });
    return holders;
}

std::vector<PortHolder> find_port_competitors(const std::string& port, const fs::path& proc) {
    auto holders = find_port_holders(port, proc);
    std::erase_if(holders, [](const PortHolder& holder) { return holder.is_emulator; });
    return holders;
}

}  // namespace sweepcast::link
