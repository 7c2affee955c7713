// One text per cause of not opening a port.
#include "driver/link/open_problem.hpp"

#include "driver/async/blocking.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <fcntl.h>
#include <functional>
#include <grp.h>
#include <iterator>
#include <pwd.h>
#include <string_view>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace sweepcast::link {

namespace {

std::string name_of_group(gid_t gid) {
    std::array<char, 4096> buffer{};
    group entry{};
    group* found = nullptr;
    ::getgrgid_r(gid, &entry, buffer.data(), buffer.size(), &found);
    return found != nullptr ? found->gr_name : std::to_string(gid);
}

std::string name_of_user(uid_t uid) {
    std::array<char, 4096> buffer{};
    passwd entry{};
    passwd* found = nullptr;
    ::getpwuid_r(uid, &entry, buffer.data(), buffer.size(), &found);
    return found != nullptr ? found->pw_name : std::to_string(uid);
}

/// Whether `user` is in `gid` by the user database, though this process is not: it was put into the
/// group after it logged in.
bool joined_since_login(const std::string& user, gid_t gid) {
    std::array<gid_t, 256> of_process{};
    const int count = ::getgroups(static_cast<int>(of_process.size()), of_process.data());
    const auto end = std::next(of_process.cbegin(), std::max(count, 0));
    if (::getegid() == gid || std::find(of_process.cbegin(), end, gid) != end) {
        return false;
    }
    std::array<char, 4096> buffer{};
    group entry{};
    group* found = nullptr;
    ::getgrgid_r(gid, &entry, buffer.data(), buffer.size(), &found);
    for (char** name = found != nullptr ? found->gr_mem : nullptr; name != nullptr && *name;
         ++name) {
        if (user == *name) {
            return true;
        }
    }
    return false;
}

std::string text_of(int error) {
    return std::system_category().message(error);
}

/// "the serial ports here are /dev/ttyUSB0 (CP2102 ...)", or what to check if there is none.
std::string ports_there_are(const std::vector<SerialPort>& ports) {
    if (ports.empty()) {
        return "no USB serial port was found: plug the adapter in, try another cable or socket, "
               "and see whether "
               "`dmesg` mentions it";
    }
    std::string text =
        ports.size() == 1 ? "the only USB serial port here is " : "the USB serial ports here are ";
    for (const auto& port : ports) {
        text += &port == &ports.front() ? "" : ", ";
        text += port.path;
        if (!port.product.empty()) {
            text += " (" + port.product + ")";
        }
    }
    return text;
}

Problem explain_not_found(const std::string& path, int error, const PortFacts& facts) {
    std::string cause = "there is no port " + path;
    if (facts.mode) {
        cause = "there is no device behind " + path + ": " + text_of(error);
    }
    return {errc::port_not_found, cause, ports_there_are(facts.ports)};
}

Problem explain_permission(const std::string& path, int error, const PortFacts& facts) {
    Problem problem{errc::permission_denied, "user " + facts.user + " may not open " + path, {}};
    constexpr mode_t group_may = S_IRGRP | S_IWGRP;
    if (error == EPERM) {
        // File permissions give EACCES; EPERM comes from the device rules of containers and
        // services.
        problem.cause = "the system forbids this process to open " + path;
        problem.hint = "in a container: run it with --device=" + path +
                       "; as a service: allow the device (DeviceAllow=)";
    } else if (facts.mode && (*facts.mode & group_may) == group_may && facts.group != "root") {
        problem.cause += ", which belongs to group " + facts.group;
        if (facts.member) {
            problem.cause += ": it is in that group, but this login does not know yet";
            problem.hint =
                "log out and in again, or restart the service (for this terminal alone: "
                "newgrp " +
                facts.group + ")";
            return problem;
        }
        problem.hint = "sudo usermod -aG " + facts.group + " " + facts.user +
                       " ; then log in again, or restart the service";
    } else {
        problem.hint = "let a group use it: sudo chgrp dialout " + path + " && sudo chmod 660 " +
                       path + " ; sudo usermod -aG dialout " + facts.user +
                       " (a udev rule makes it last)";
    }
    return problem;
}

struct KnownHolder {
    std::string_view command;
    std::string_view hint;
};

/// Programs that take serial ports without being asked.
constexpr std::array<KnownHolder, 3> known_holders{{
    {"ModemManager",
     "it probes serial ports for modems: sudo systemctl disable --now ModemManager"},
    {"brltty", "it takes CH340 adapters for braille displays: sudo apt remove brltty"},
    {"gpsd",
     "it takes serial ports for GPS receivers: sudo systemctl disable --now gpsd gpsd.socket"},
}};

std::string hint_to_stop(const PortHolder& holder) {
    if (holder.command == "sweepcast") {
        return "if that is a gateway, its page and its API show this lidar (curl "
               "http://127.0.0.1:8080/api/v1/lidars); else stop it first (kill " +
               std::to_string(holder.pid) + ")";
    }
    const auto* known =
        std::find_if(known_holders.begin(), known_holders.end(), [&](const auto& entry) {
            return entry.command == holder.command;
        });
    if (known != known_holders.end()) {
        return std::string(known->hint);
    }
    return "stop it first (kill " + std::to_string(holder.pid) + "), or use another port";
}

Problem explain_busy(const std::string& path, const PortFacts& facts) {
    Problem problem{errc::port_busy, path + " is in use", {}};
    const auto is_other = [&](const auto& holder) { return holder.pid != facts.own_pid; };
    auto other = std::find_if(facts.holders.begin(), facts.holders.end(), [&](const auto& holder) {
        return is_other(holder) && !holder.is_emulator;
    });
    if (other == facts.holders.end()) {  // an emulator too can lock its port
        other = std::find_if(facts.holders.begin(), facts.holders.end(), is_other);
    }
    if (other != facts.holders.end()) {
        problem.cause += " by " + other->command + " (process " + std::to_string(other->pid) + ")";
        problem.hint = hint_to_stop(*other);
    } else if (!facts.holders.empty()) {
        problem.cause += " by this very process (" + std::to_string(facts.own_pid) + ")";
        problem.hint = "name each port once: two names may lead to the same one";
    } else {
        problem.cause += " by a process of another user";
        problem.hint = "find and stop it: sudo fuser -v " + path;
    }
    return problem;
}

Problem explain_not_serial(const std::string& path, const PortFacts& facts) {
    std::string kind = "not a serial port";
    if (facts.mode && S_ISDIR(*facts.mode)) {
        kind = "a directory, not a serial port";
    } else if (facts.mode && S_ISREG(*facts.mode)) {
        kind = "a regular file, not a serial port";
    }
    return {errc::not_a_serial_port, path + " is " + kind, ports_there_are(facts.ports)};
}

Problem explain_io_error(const std::string& path, int error, const PortFacts& facts) {
    if (error == EIO) {
        return {
            errc::io_error,
            "no working serial hardware answers behind " + path + " (" + text_of(error) + ")",
            ports_there_are(facts.ports)};
    }
    return {
        errc::io_error,
        "opening " + path + " failed: " + text_of(error),
        "see whether `dmesg` says more about it"};
}

}  // namespace

PortFacts gather_port_facts(const std::string& path) {
    PortFacts facts;
    facts.user = name_of_user(::geteuid());
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0) {
        facts.mode = status.st_mode;
        facts.group = name_of_group(status.st_gid);
        facts.member = joined_since_login(facts.user, status.st_gid);
    }
    facts.holders = find_port_holders(path);
    facts.ports = list_usb_ports();
    facts.own_pid = ::getpid();
    return facts;
}

boost::asio::awaitable<PortFacts> look_up_port_facts(std::string path) {
    constexpr auto limit = std::chrono::seconds(2);
    std::string lane = "facts of " + path;
    std::function<PortFacts()> gather = [path] { return gather_port_facts(path); };
    const auto deadline = std::chrono::steady_clock::now() + limit;
    auto facts =
        co_await async::run_blocking<PortFacts>(std::move(lane), deadline, std::move(gather));
    co_return facts ? std::move(*facts) : PortFacts{};
}

int find_open_obstacle(const std::string& path) {
    return ::faccessat(AT_FDCWD, path.c_str(), R_OK | W_OK, AT_EACCESS) == 0 ? 0 : errno;
}

errc classify_open_error(int error) {
    switch (error) {
    case ENOENT:
    case ENOTDIR:
    case ENODEV:
    case ENXIO:
    case ELOOP:
    case ENAMETOOLONG:
        return errc::port_not_found;
    case EACCES:
    case EPERM:
    case EROFS:
        return errc::permission_denied;
    case EBUSY:
    case EWOULDBLOCK:
        return errc::port_busy;
    case EISDIR:
    case ENOTTY:
    case EINVAL:
        return errc::not_a_serial_port;
    default:
        return errc::io_error;
    }
}

Problem explain_open_error(const std::string& path, int error, const PortFacts& facts) {
    switch (classify_open_error(error)) {
    case errc::port_not_found:
        return explain_not_found(path, error, facts);
    case errc::permission_denied:
        return explain_permission(path, error, facts);
    case errc::port_busy:
        return explain_busy(path, facts);
    case errc::not_a_serial_port:
        return explain_not_serial(path, facts);
    default:
        return explain_io_error(path, error, facts);
    }
}

Problem explain_baud(const std::string& path, std::uint32_t asked, std::uint32_t actual) {
    if (asked == 0) {
        return {
            errc::baud_not_supported,
            "a baud rate of 0 was asked for on " + path,
            "set the baud rate of the lidar: 115200, 256000, 460800 or 1000000, by model"};
    }
    return {
        errc::baud_not_supported,
        "the adapter at " + path + " cannot run at " + std::to_string(asked) + " baud (it chose " +
            std::to_string(actual) + ")",
        "use the adapter that came with the lidar, or a CP2102N or CH343 one"};
}

}  // namespace sweepcast::link
