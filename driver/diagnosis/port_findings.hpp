// What the checks of a port say: does it exist, may we open it, who holds it, does it open. Pure.
#pragma once

#include "driver/diagnosis/finding.hpp"
#include "driver/link/open_problem.hpp"
#include "driver/protocol/result.hpp"

#include <string>

namespace sweepcast::diagnosis {

/// What was seen of a serial port before it was opened.
struct PortLook {
    std::string path;
    int error{};  ///< errno of what forbids to open it; 0: nothing seen
    link::PortFacts facts;

    /// The USB adapter behind the port, if it is one.
    [[nodiscard]] const link::SerialPort* adapter() const;
};

[[nodiscard]] Finding judge_port(const PortLook& port);
[[nodiscard]] Finding judge_permission(const PortLook& port);
/// `refused`: opening it said that it is in use.
[[nodiscard]] Finding judge_holder(const PortLook& port, bool refused);

/// `problem` is why the port or the network address could not be opened. Those of missing ports,
/// rights and other users belong to the checks above; this returns the finding of the right one.
[[nodiscard]] Finding judge_failed_opening(const PortLook& port, const Problem& problem);
[[nodiscard]] Finding judge_failed_connection(const std::string& url, const Problem& problem);

/// There is not a single port where a lidar could be. `ports` are those that were left alone.
[[nodiscard]] Finding judge_no_port(const std::vector<link::SerialPort>& ports);

/// "/dev/ttyUSB0: CP2102 USB to UART Bridge Controller (10c4:ea60)".
[[nodiscard]] std::string describe(const link::SerialPort& port);

}  // namespace sweepcast::diagnosis
