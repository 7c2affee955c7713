#include "driver/diagnosis/port_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace sweepcast::diagnosis {

namespace {

using link::errc;

Finding failed(Step step, const Problem& problem) {
    return {step, Verdict::failed, problem.cause, problem.cause, {}, {problem.hint}};
}

errc class_of(const PortLook& port) {
    return link::classify_open_error(port.error);
}

/// The ports of real adapters are called so; others are made by programs, such as virtual lidars.
bool is_adapter_name(const std::string& path) {
    return path.starts_with("/dev/tty") || path.starts_with("/dev/serial/");
}

Finding missing_port(const PortLook& port, const Problem& problem) {
    auto finding = failed(Step::port, problem);
    auto& likely = finding.likely_causes;
    if (!is_adapter_name(port.path)) {
        likely.emplace_back(
            "the virtual lidar whose port this was has ended, or the name is misspelt"
        );
        finding.next_steps.insert(
            finding.next_steps.begin(),
            fmt::format("start the virtual lidar again: sweepcast virtual --link {}", port.path)
        );
        return finding;
    }
    if (!port.facts.ports.empty()) {
        likely.emplace_back(
            "the adapter has got another name: names change with the order of "
            "plugging in, those in /dev/serial/by-id stay"
        );
    }
    likely.emplace_back(
        "the adapter is not plugged in, or its USB cable is a charging cable, "
        "without wires for data"
    );
    likely.emplace_back("the USB device has not been passed on to this virtual machine or container"
    );
    finding.next_steps.emplace_back(
        "unplug the adapter, plug it in again, and read what `sudo dmesg | tail` says about it"
    );
    finding.next_steps.emplace_back(
        "in a virtual machine: attach the USB device to it; in a container: run it with "
        "--device=" +
        port.path
    );
    return finding;
}

}  // namespace

const link::SerialPort* PortLook::adapter() const {
    const auto found = std::ranges::find_if(facts.ports, [&](const link::SerialPort& candidate) {
        return path == candidate.path || path == candidate.by_id || path == candidate.by_path;
    });
    return found == facts.ports.end() ? nullptr : &*found;
}

std::string describe(const link::SerialPort& port) {
    return fmt::format(
        "{}: {} ({:04x}:{:04x})",
        port.path,
        port.product.empty() ? "USB serial adapter" : port.product,
        port.vendor_id,
        port.product_id
    );
}

Finding judge_port(const PortLook& port) {
    if (port.error != 0 && class_of(port) == errc::port_not_found) {
        return missing_port(port, link::explain_open_error(port.path, port.error, port.facts));
    }
    const auto* adapter = port.adapter();
    return {Step::port, Verdict::ok, adapter != nullptr ? describe(*adapter) : port.path};
}

Finding judge_permission(const PortLook& port) {
    if (port.error == 0 || class_of(port) != errc::permission_denied) {
        return {Step::permission, Verdict::ok, "as user " + port.facts.user};
    }
    auto finding =
        failed(Step::permission, link::explain_open_error(port.path, port.error, port.facts));
    if (port.error != EPERM) {
        finding.likely_causes.emplace_back(
            port.facts.member ? "a login knows only the groups that its user had when it began"
                              : "serial ports are open to the members of one group, and nobody is "
                                "one until told so"
        );
        finding.next_steps.emplace_back("see which groups this login has: id -nG");
        finding.next_steps.emplace_back(
            "to see at once whether all else is well: sudo sweepcast doctor " + port.path
        );
    } else {
        finding.likely_causes.emplace_back(
            "a container or a service may only use devices that it "
            "was given"
        );
    }
    return finding;
}

Finding judge_holder(const PortLook& port, bool refused) {
    const bool others = std::ranges::any_of(port.facts.holders, [&](const auto& holder) {
        return holder.pid != port.facts.own_pid && !holder.is_emulator;
    });
    if (!refused && !others) {
        return {Step::holder, Verdict::ok, "no other process has it open"};
    }
    auto finding = failed(Step::holder, link::explain_open_error(port.path, EBUSY, port.facts));
    finding.likely_causes.emplace_back(
        "two programs that read one port take the bytes from each other, so only one may have it"
    );
    if (std::ranges::any_of(port.facts.holders, [](const auto& holder) {
            return holder.command == "sweepcast";
        })) {
        finding.next_steps.emplace_back(
            "a gateway tells of its own lidars: curl "
            "http://127.0.0.1:8080/api/v1/lidars/ID/diagnosis"
        );
    }
    finding.next_steps.push_back("then run again: sweepcast doctor " + port.path);
    return finding;
}

Finding judge_failed_opening(const PortLook& port, const Problem& problem) {
    if (problem.code == errc::port_busy) {
        return judge_holder(port, true);
    }
    if (problem.code == errc::port_not_found) {
        return missing_port(port, problem);
    }
    if (problem.code == errc::permission_denied) {
        return failed(Step::permission, problem);
    }
    auto finding = failed(Step::open, problem);
    if (problem.code == errc::not_a_serial_port) {
        finding.likely_causes.emplace_back("the name is misspelt");
    } else if (problem.code == errc::baud_not_supported) {
        finding.likely_causes.emplace_back(
            "the adapter is older than the lidar: CP2102 and CH340 "
            "ones do not reach every speed"
        );
    } else {
        finding.likely_causes.emplace_back("the adapter or its driver is in a bad state");
        finding.next_steps.emplace_back("unplug the adapter, wait a few seconds, plug it in again");
    }
    return finding;
}

Finding judge_failed_connection(const std::string& url, const Problem& problem) {
    auto finding = failed(Step::open, problem);
    finding.likely_causes = {
        "the lidar, or the bridge that it hangs on, is off or not in this network",
        "the address or the port is not its own (usual: udp://192.168.11.2:8089 for a T1 or S2E, "
        "port 20108 for the TCP bridge of an S1)",
        "a firewall on the way drops what it does not know"};
    finding.next_steps.emplace_back(
        "see whether the address answers at all: ping, and `ip addr` for "
        "an address of this machine in the same network"
    );
    finding.next_steps.push_back("then run again: sweepcast doctor " + url);
    return finding;
}

Finding judge_no_port(const std::vector<link::SerialPort>& ports) {
    Finding finding{
        Step::port,
        Verdict::failed,
        "no USB adapter of a kind that RPLIDARs come with",
        "no port where a lidar could be was found",
        {"the lidar's USB adapter is not plugged in, or its cable is a charging cable, without "
         "wires for data",
         "the USB device has not been passed on to this virtual machine or container",
         "the kernel has no driver for the adapter (it needs cp210x or ch341)"},
        {"plug the adapter in and read what `sudo dmesg | tail` says: it should name a cp210x or "
         "ch341 converter and its port, such as ttyUSB0",
         "see whether the machine has the adapter at all: `lsusb` (10c4:ea60 is a CP210x, "
         "1a86:7523 a CH340)",
         "in a virtual machine: attach the USB device to it; in a container: run it with "
         "--device=/dev/ttyUSB0",
         "a lidar on a UART of the board, or on a network, must be named: sweepcast doctor "
         "/dev/ttyS0, sweepcast doctor udp://192.168.11.2:8089"}};
    if (!ports.empty()) {
        std::string others;
        for (const auto& port : ports) {
            others += (others.empty() ? "" : ", ") + describe(port);
        }
        finding.seen += "; others were left alone: " + others;
        finding.likely_causes.insert(
            finding.likely_causes.begin(),
            "the lidar hangs on an adapter of another kind: " + others
        );
        finding.next_steps.insert(
            finding.next_steps.begin(),
            "name the port, if you know that it is the lidar's: sweepcast doctor " +
                ports.front().path
        );
    }
    return finding;
}

}  // namespace sweepcast::diagnosis
