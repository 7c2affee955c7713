// Why a port could not be opened, in words: what happened and what to do about it.
#pragma once

#include "driver/link/error.hpp"
#include "driver/link/port_holder.hpp"
#include "driver/link/port_list.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace sweepcast::link {

/// What the system knows of a port that could not be opened.
struct PortFacts {
    std::optional<mode_t> mode;  ///< of the device file, if there is one
    std::string group;           ///< that owns the device file, e.g. "dialout"
    std::string user;            ///< as whom we run
    bool member{};  ///< the user has been put into the group, which this login does not know yet
    std::vector<PortHolder> holders;  ///< who has it open
    std::vector<SerialPort> ports;    ///< the USB ports there are
    pid_t own_pid{};
};

/// Asks the system about `path`.
PortFacts gather_port_facts(const std::string& path);

/// As gather_port_facts(), but on another thread: looking through all processes takes a while.
/// Gives nothing of what the system does not tell within two seconds.
/// Throws boost::system::system_error (operation_aborted) if the coroutine is cancelled meanwhile.
boost::asio::awaitable<PortFacts> look_up_port_facts(std::string path);

/// What forbids us to read and write `path`, without opening it, which would disturb others: an
/// errno value, 0 if nothing does.
int find_open_obstacle(const std::string& path);

/// The link error that stands for what open(2), flock(2) or ioctl(2) reported of a port.
errc classify_open_error(int error);

/// Explains the errno value `error` of opening `path`. Pure.
Problem explain_open_error(const std::string& path, int error, const PortFacts& facts);

/// Explains that the adapter at `path` runs at `actual` baud when asked for `asked`. Pure.
Problem explain_baud(const std::string& path, std::uint32_t asked, std::uint32_t actual);

}  // namespace sweepcast::link
