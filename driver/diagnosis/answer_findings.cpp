#include "driver/diagnosis/answer_findings.hpp"

#include "driver/device/advice.hpp"
#include "driver/device/error.hpp"
#include "driver/diagnosis/adapters.hpp"
#include "driver/diagnosis/next_steps.hpp"
#include "driver/protocol/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sweepcast::diagnosis {

namespace {

std::string at(const Heard& heard) {
    return heard.baud == 0 ? "" : fmt::format(" at {} baud", heard.baud);
}

/// "115200, 256000 or 1000000 baud".
std::string speeds(const std::vector<Heard>& heard) {
    std::string text;
    for (const auto& each : heard) {
        const bool last = &each == &heard.back();
        text += text.empty() ? "" : (last ? " or " : ", ");
        text += std::to_string(each.baud);
    }
    return text + " baud";
}

/// What was heard at each speed: "nothing at 115200 baud; noise (37 bytes) at 256000 baud".
std::string all_heard(const LineLook& line) {
    std::string text;
    for (const auto& heard : line.heard) {
        text += text.empty() ? "" : "; ";
        if (!heard.possible) {
            text += fmt::format("{} baud is not possible with this adapter", heard.baud);
        } else if (heard.kind == HeardKind::nothing) {
            text += "nothing" + at(heard);
        } else {
            text += fmt::format("{} ({} bytes){}", name(heard.kind), heard.bytes, at(heard));
        }
    }
    return text;
}

/// What the adapter itself may have to do with it, if it is one that is known for something.
void add_adapter_doubts(const LineLook& line, std::vector<std::string>& likely) {
    const bool impossible =
        std::ranges::any_of(line.heard, [](const Heard& heard) { return !heard.possible; });
    if (impossible) {
        likely.emplace_back(
            "the lidar needs a line speed that this adapter cannot run at: a C1 "
            "460800 baud, an S2 or S3 1000000"
        );
    } else if (line.adapter && line.adapter->vendor_id == qinheng) {
        likely.emplace_back(fmt::format(
            "a CH340 adapter such as this one may fail from {} baud on, which a C1, S2 or S3 "
            "needs",
            fast_baud
        ));
    } else if (line.adapter && line.adapter->vendor_id != silicon_labs) {
        likely.emplace_back(
            "this adapter is of no kind that RPLIDARs come with: it may not run at "
            "the lidar's speed, or belong to another device"
        );
    }
}

Finding silent_serial(const LineLook& line) {
    Finding finding{
        Step::bytes,
        Verdict::failed,
        all_heard(line),
        fmt::format("nothing answers on {}: not a byte came at {}", line.url, speeds(line.heard)),
        {"the lidar has no power, or too little: some models take it by a second plug",
         "the cable between lidar and adapter is loose, broken, or has TX and RX swapped",
         "the port belongs to another device, which does not know an RPLIDAR's requests"},
        {"look at the lidar: does its motor turn, or a light shine, when it gets power? If not, "
         "give it power first",
         "unplug everything, plug it in again firmly, with another USB cable and directly into the "
         "computer",
         "check the wires: the lidar's TX to the adapter's RX, its RX to the adapter's TX, ground "
         "to "
         "ground",
         "then run again: sweepcast doctor " + line.url}};
    add_adapter_doubts(line, finding.likely_causes);
    return finding;
}

Finding silent_network(const LineLook& line) {
    return {
        Step::bytes,
        Verdict::failed,
        "not a byte came",
        "nothing answers at " + line.url,
        {"the lidar is off, or still booting",
         "the address or the port is not its own (usual: udp://192.168.11.2:8089 for a T1 or S2E, "
         "port 20108 for the TCP bridge of an S1)",
         "this machine has no address in the lidar's network, or a firewall drops the answers",
         "another program talks to the lidar: it answers one at a time"},
        {"see that the lidar's network plug blinks, and that `ip addr` shows an address of this "
         "machine in its network, e.g. 192.168.11.3/24",
         "ping the address",
         "stop other programs that use it, then run again: sweepcast doctor " + line.url}};
}

Finding wrong_baud(const LineLook& line, const Heard& heard) {
    const auto who = heard.info
                         ? fmt::format("the lidar ({})", protocol::model_name(heard.info->model))
                         : std::string("the lidar");
    if (heard.info && protocol::knows_baud_negotiation(*heard.info)) {
        return {
            Step::bytes,
            Verdict::warning,
            all_heard(line),
            fmt::format("{} speaks at {} baud, not at {}", who, heard.baud, *line.asked_baud),
            {"nobody has talked it into another speed since it got its power"},
            {"nothing need be done: a gateway talks it into the speed asked for",
             fmt::format("to save that time, write ?baud={}, or leave it out", heard.baud)}};
    }
    return {
        Step::bytes,
        Verdict::failed,
        all_heard(line),
        fmt::format("{} speaks at {} baud, not at {}", who, heard.baud, *line.asked_baud),
        {"the speed was taken from another model: A1 and A2M8 115200; A2M7, A2M12, A3 and S1 "
         "256000; C1 460800; S2 and S3 1000000",
         "the adapter board of some models has a switch for the speed, and it is in the other "
         "position"},
        {fmt::format(
            "write the right speed, ?baud={}, or leave it out: then it is found",
            heard.baud
        )}};
}

Finding noise(const LineLook& line) {
    Finding finding{
        Step::bytes,
        Verdict::failed,
        all_heard(line),
        fmt::format(
            "bytes come on {}, but they make no sense{}",
            line.url,
            line.network ? "" : " at " + speeds(line.heard)
        ),
        {},
        {"take the adapter and the cable that came with the lidar, as short as possible, and plug "
         "it directly into the computer",
         "connect the grounds of lidar, adapter and computer",
         "unplug the lidar from the adapter: if bytes still come, they are not the lidar's",
         "then run again: sweepcast doctor " + line.url}};
    add_adapter_doubts(line, finding.likely_causes);
    finding.likely_causes.emplace_back(
        "the line is disturbed: a long or bad cable, no common "
        "ground, motor leads beside it"
    );
    finding.likely_causes.emplace_back(
        "the port belongs to another device, which speaks at another speed"
    );
    return finding;
}

Finding rebooting(const Heard& heard) {
    const auto times =
        heard.boots > 1 ? fmt::format(", {} times while we listened", heard.boots) : std::string();
    return {
        Step::descriptor,
        Verdict::failed,
        fmt::format("boot text (\"{}\"){}, but no answer", heard.text, times),
        "the lidar says that it boots" + times + ", and answers nothing",
        {"its supply breaks down, so it boots again and again: a USB port or hub that gives too "
         "little current, or a long thin cable",
         "it was only just switched on, and booted while it was asked",
         "its firmware is damaged, if it goes on like this with a good supply"},
        {std::string(supply_advice),
         "listen again in a few seconds: sweepcast doctor; if the boot text is still all, it is "
         "the "
         "supply or the lidar"}};
}

Finding deaf(const Heard& heard) {
    return {
        Step::descriptor,
        Verdict::failed,
        fmt::format(
            "scan data ({} bytes){}, before and after it was told to stop",
            heard.bytes,
            at(heard)
        ),
        "the lidar scans and is heard, but does not hear us: it neither stops nor answers",
        {"the wire from the adapter's TX to the lidar's RX is broken or not connected",
         "another program started the scan and shares the line",
         "the scan's data drowns the answer, because bytes are lost on the line"},
        {"check the wire between the adapter's TX and the lidar's RX",
         "take the lidar's power away for a moment, which ends the scan, and run again"}};
}

Finding foreign(const LineLook& line, const Heard& heard) {
    return {
        Step::descriptor,
        Verdict::failed,
        fmt::format("text{}: \"{}\"", at(heard), heard.text),
        "another device speaks on " + line.url + ", not an RPLIDAR",
        {"the port belongs to something else, such as a GPS receiver or a microcontroller",
         "two adapters have swapped their names since they were plugged in"},
        {"name the lidar's own port; names that stay: ls -l /dev/serial/by-id",
         "to see which ports there are and what is at them: sweepcast doctor"}};
}

}  // namespace

const Heard& LineLook::best() const {
    return *std::ranges::max_element(heard, {}, &Heard::kind);
}

Finding judge_broken_line(const LineLook& line, const error_code& failure) {
    Finding finding{
        Step::bytes,
        Verdict::failed,
        failure.message(),
        fmt::format("the connection to {} broke while we listened", line.url),
        {"the adapter was unplugged, or has a loose contact",
         "the adapter switched itself off: the lidar draws more current than the USB port gives"},
        {std::string(cable_advice),
         "see whether `sudo dmesg | tail` speaks of over-current or of a disconnect",
         std::string(supply_advice)}};
    if (line.network) {
        finding.likely_causes = {
            "nothing listens on this port of that host: another address or port is the lidar's",
            "someone else is connected to the lidar, or to the bridge that it hangs on"};
        finding.next_steps = {
            "check address and port (usual: udp://192.168.11.2:8089 for a T1 or S2E, port 20108 "
            "for the TCP bridge of an S1)",
            "stop other programs that use it, then run again: sweepcast doctor " + line.url};
    }
    return finding;
}

Finding judge_bytes(const LineLook& line) {
    const auto& best = line.best();
    if (best.kind == HeardKind::nothing) {
        return line.network ? silent_network(line) : silent_serial(line);
    }
    if (line.asked_baud && best.baud != *line.asked_baud && best.kind >= HeardKind::boot_text) {
        return wrong_baud(line, best);
    }
    if (best.kind == HeardKind::noise) {
        return noise(line);
    }
    return {Step::bytes, Verdict::ok, fmt::format("{}{}", name(best.kind), at(best))};
}

Finding judge_descriptor(const LineLook& line) {
    const auto& best = line.best();
    switch (best.kind) {
    case HeardKind::answer:
        return {Step::descriptor, Verdict::ok, "A5 5A 14 00 00 00 04, as it should be"};
    case HeardKind::boot_text:
        return rebooting(best);
    case HeardKind::scan_data:
        return deaf(best);
    default:
        return foreign(line, best);
    }
}

Finding judge_info(const std::optional<protocol::DeviceInfo>& info, const std::string& alias) {
    if (!info) {
        return {
            Step::info,
            Verdict::failed,
            "the answer broke off, or was never the same twice",
            "the lidar's answer does not come whole",
            {"bytes are lost on the line: a bad cable or plug, or an adapter that is too slow",
             "another program reads the same port and takes some of them"},
            {std::string(cable_advice), "stop other programs that use the port, then run again"}};
    }
    auto model = protocol::model_name(info->model);
    if (!alias.empty() && alias != model) {
        model += " (" + alias + ")";
    }
    return {
        Step::info,
        Verdict::ok,
        fmt::format(
            "{}, serial number {}, firmware {}.{:02}, hardware {}",
            model,
            protocol::serial_text(info->serial),
            info->firmware_major,
            info->firmware_minor,
            info->hardware
        )};
}

Finding judge_health(const Result<protocol::Health>& health) {
    if (!health) {
        return {
            Step::health,
            Verdict::failed,
            "no answer",
            "the lidar says who it is, but not how it is",
            {"bytes are lost on the line", "it lost its power just now"},
            {std::string(cable_advice), std::string(supply_advice)}};
    }
    switch (health->status) {
    case protocol::HealthStatus::good:
        return {Step::health, Verdict::ok, "good"};
    case protocol::HealthStatus::warning:
        return {
            Step::health,
            Verdict::warning,
            fmt::format("warning, code {:#06x}", health->code),
            fmt::format("the lidar warns of itself (code {:#06x}); it still works", health->code),
            {"it is about to fail, or works outside of its limits: heat, supply, dust on the "
             "optics"},
            {"see that it is clean, cool and has a good supply; if the warning stays, ask the "
             "maker, "
             "with the code"}};
    case protocol::HealthStatus::error:
        break;
    }
    const auto problem = device::advice(device::errc::protection_stop);
    return {
        Step::health,
        Verdict::failed,
        fmt::format("error, code {:#06x}: protection stop", health->code),
        fmt::format(
            "{} (error code {:#06x}): it has switched itself off and will not scan",
            problem.cause,
            health->code
        ),
        {"something blocks its head, or blocked it: hair, a cable, its transport protection",
         "its supply broke down when the motor started",
         "its motor or its laser is broken, if the error is back after every reset"},
        {"take its power away and turn the head by hand: it must turn easily",
         "reset it: give it its power again, or with a gateway running: curl -X POST "
         "http://127.0.0.1:8080/api/v1/lidars/ID/reset",
         std::string(supply_advice),
         "if it comes back at once, the lidar is broken: keep the code for the maker"}};
}

Finding judge_modes(const Result<std::vector<device::ScanMode>>& modes) {
    if (!modes || modes->empty()) {
        return {
            Step::modes,
            Verdict::failed,
            "no answer",
            "the lidar does not say how it can scan",
            {"bytes are lost on the line", "it lost its power just now"},
            {std::string(cable_advice), std::string(supply_advice)}};
    }
    std::string text;
    for (const auto& mode : *modes) {
        text += fmt::format(
            "{}{} ({}{})",
            text.empty() ? "" : ", ",
            mode.name,
            mode.sample_duration.count() > 0
                ? fmt::format("{:.1f} kHz", mode.samples_per_second() / 1000.0)
                : "rate not told",
            mode.typical ? ", typical" : ""
        );
    }
    return {Step::modes, Verdict::ok, text};
}

}  // namespace sweepcast::diagnosis
