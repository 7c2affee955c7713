#include "driver/diagnosis/scan_findings.hpp"

#include "driver/diagnosis/adapters.hpp"
#include "driver/diagnosis/answer_findings.hpp"
#include "driver/diagnosis/next_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace sweepcast::diagnosis {

namespace {

using protocol::MotorControl;

double seconds(std::chrono::milliseconds time) {
    return static_cast<double>(time.count()) / 1000.0;
}

Finding unplugged(const SpinLook& spin) {
    return {
        Step::motor,
        Verdict::failed,
        fmt::format(
            "the port vanished {:.1f} s after the motor was switched on",
            seconds(spin.waited)
        ),
        "the connection broke when the motor started",
        {"the motor draws more current than the USB port gives, and the port switched itself off",
         "the cable was pulled, or has a loose contact"},
        {std::string(supply_advice),
         "see whether `sudo dmesg | tail` speaks of over-current or of a disconnect"}};
}

Finding booted(const SpinLook& spin) {
    return {
        Step::motor,
        Verdict::failed,
        fmt::format("boot text instead of samples: \"{}\"", spin.heard.text),
        "the lidar booted again when its motor started",
        {"its supply breaks down under the current that the motor draws at its start"},
        {std::string(supply_advice),
         "turn the head by hand, without power: it must turn easily, or the motor draws too much"}};
}

Finding protected_itself(const SpinLook& spin) {
    auto finding = judge_health(*spin.health_after);
    finding.step = Step::motor;
    finding.seen = "no samples, then " + finding.seen;
    finding.cause = fmt::format(
        "the lidar went into protection stop when its motor started (error code {:#06x})",
        spin.health_after->code
    );
    return finding;
}

Finding refused(const SpinLook& spin) {
    return {
        Step::motor,
        Verdict::failed,
        fmt::format("no answer to the request for a scan in mode {}", spin.mode),
        spin.health_after ? "the lidar answers, but does not accept a scan in mode " + spin.mode
                          : "the lidar fell silent when it was told to scan",
        {spin.health_after ? "it does not have this mode, whatever its list says"
                           : "its supply broke down when the motor started",
         "the request was damaged on the line"},
        {"run again; if it is the same, take another mode: sweepcast serve --mode Standard",
         std::string(supply_advice)}};
}

/// Where to look when this kind of motor stands still, likeliest first.
std::vector<std::string> reasons_to_stand_still(const SpinLook& spin) {
    std::vector<std::string> likely;
    switch (spin.control) {
    case MotorControl::modem_line:
        likely = {
            "the motor has no 5 V of its own (on an A1: the VMOTO pin), or too little",
            "the adapter does not lead DTR to the motor's switch (on an A1: the MOTOCTL pin, which "
            "must be high), as the board that comes with the lidar does"};
        break;
    case MotorControl::accessory_board:
        likely = {
            "the board between lidar and USB has no supply of its own, or too little",
            "the plug between the board and the lidar is not in all the way: the motor's wires are "
            "in it"};
        break;
    case MotorControl::rpm:
    case MotorControl::self:
        likely = {"the supply is too weak for the motor, though enough to answer"};
        break;
    }
    likely.emplace_back("the head is blocked: its transport protection, a cable, hair, dust");
    likely.emplace_back("the motor or its driver is broken");
    return likely;
}

Finding stands_still(const SpinLook& spin) {
    return {
        Step::motor,
        Verdict::failed,
        fmt::format(
            "no sample within {:.1f} s of a scan in mode {}, though the lidar accepted it",
            seconds(spin.waited),
            spin.mode
        ),
        "the motor does not turn, or not at a stable speed: until it does, the lidar measures "
        "nothing",
        reasons_to_stand_still(spin),
        {"look at the head: does it turn? If it does, wait until it is warm, and run again",
         "take the power away and turn it by hand: it must turn easily, without grinding",
         std::string(supply_advice),
         "take the adapter board and the cable that came with the lidar"}};
}

Finding garbled(const SpinLook& spin) {
    return {
        Step::motor,
        Verdict::failed,
        fmt::format("{} bytes, but not one whole packet", spin.heard.bytes),
        "the lidar sends, but nothing of it arrives whole",
        {"the line is disturbed by the motor, or bytes are lost: bad cable, no common ground",
         "another program reads the same port and takes some of the bytes"},
        {std::string(cable_advice), "connect the grounds of lidar, adapter and computer"}};
}

std::string in_percent(double part) {
    return fmt::format("{:.2g} %", part * 100.0);
}

std::string count(const QualityLook& quality) {
    const auto& line = quality.line;
    if (line.checksum_errors + line.lost_packets + line.skipped_bytes == 0) {
        return fmt::format("{} bytes, {} samples, none damaged or lost", line.bytes, line.samples);
    }
    return fmt::format(
        "{} bytes, {} samples, {} damaged packets, {} lost packets, {} bytes without meaning: {} "
        "damaged",
        line.bytes,
        line.samples,
        line.checksum_errors,
        line.lost_packets,
        line.skipped_bytes,
        in_percent(quality.damage())
    );
}

std::vector<std::string> reasons_for_damage(const QualityLook& quality) {
    if (quality.line.baud == 0) {
        return {
            "the network loses datagrams: a wireless link, a busy switch",
            "this machine is too busy to take them in time"};
    }
    std::vector<std::string> likely{
        "the cable is bad, too long, or beside the motor's leads",
        "the grounds of lidar, adapter and computer are not connected, or the supply is unsteady"};
    if (quality.line.baud >= fast_baud) {
        const bool doubtful = quality.adapter && quality.adapter->vendor_id == qinheng;
        likely.insert(
            doubtful ? likely.begin() : likely.end(),
            fmt::format("the adapter is not good enough for {} baud", quality.line.baud)
        );
    }
    if (quality.line.lost_packets > quality.line.checksum_errors) {
        likely.insert(
            likely.begin(),
            "bytes get lost on their way into the computer: a USB hub, or a machine too busy to "
            "read in time"
        );
    }
    return likely;
}

}  // namespace

Finding judge_motor(const SpinLook& spin) {
    if (spin.samples > 0) {
        return {
            Step::motor,
            Verdict::ok,
            fmt::format(
                "first samples after {:.1f} s, in mode {}",
                seconds(spin.waited),
                spin.mode
            )};
    }
    if (spin.gone) {
        return unplugged(spin);
    }
    if (spin.heard.kind == HeardKind::boot_text) {
        return booted(spin);
    }
    if (spin.health_after && spin.health_after->status == protocol::HealthStatus::error) {
        return protected_itself(spin);
    }
    if (!spin.accepted) {
        return refused(spin);
    }
    return spin.heard.bytes > 0 ? garbled(spin) : stands_still(spin);
}

Finding judge_sweep(const SweepLook& sweep) {
    if (sweep.sweeps == 0) {
        return {
            Step::sweep,
            Verdict::failed,
            fmt::format(
                "{} samples in {:.1f} s, but no whole revolution",
                sweep.samples,
                seconds(sweep.waited)
            ),
            "samples come, but they do not make a revolution",
            {"so much is lost on the line that no revolution is whole",
             "the motor only just turns, or stops again"},
            {std::string(cable_advice), std::string(supply_advice)}};
    }
    if (sweep.echoes == 0) {
        return {
            Step::sweep,
            Verdict::warning,
            fmt::format("{} samples a revolution, and none of them has an echo", sweep.samples),
            "the lidar turns and measures, but sees nothing",
            {"its protective film or cap is still on, or it stands in a box",
             "nothing is within its range",
             "its laser or its receiver is broken"},
            {"hold a sheet of paper half a metre in front of it, and run again"}};
    }
    return {
        Step::sweep,
        Verdict::ok,
        fmt::format(
            "{} samples a revolution, {:.0f} % with an echo",
            sweep.samples,
            100.0 * static_cast<double>(sweep.echoes) / static_cast<double>(sweep.samples)
        )};
}

double QualityLook::damage() const {
    const auto size = static_cast<double>(std::max<std::size_t>(protocol::packet_size(type), 1));
    const auto bytes = static_cast<double>(std::max<std::uint64_t>(line.bytes, 1));
    const double packets = bytes / size + static_cast<double>(line.lost_packets);
    const auto bad = static_cast<double>(line.checksum_errors + line.lost_packets);
    return std::min(1.0, std::max(bad / packets, static_cast<double>(line.skipped_bytes) / bytes));
}

Finding judge_quality(const QualityLook& quality) {
    const double damage = quality.damage();
    if (damage < damage_to_warn_of) {
        return {Step::quality, Verdict::ok, count(quality)};
    }
    const bool bad = damage >= damage_to_fail_at;
    Finding finding{
        Step::quality,
        bad ? Verdict::failed : Verdict::warning,
        count(quality),
        fmt::format(
            "the line is {}: {} of what the lidar sends is damaged or lost",
            bad ? "bad" : "disturbed",
            in_percent(damage)
        ),
        reasons_for_damage(quality),
        {}};
    if (quality.line.baud == 0) {
        finding.next_steps = {
            "connect the lidar by cable, directly to this machine if you can, and run again"};
    } else {
        finding.next_steps = {
            std::string(cable_advice),
            "connect the grounds of lidar, adapter and computer, and lay the cable away from "
            "motors",
            "take the adapter that came with the lidar"};
    }
    return finding;
}

Finding judge_speed(const device::Rotation& rotation) {
    const double measured = rotation.measured_hz;
    const double wanted = rotation.wanted_hz > 0 ? rotation.wanted_hz : rotation.usual_hz;
    if (measured <= 0) {
        return {Step::speed, Verdict::ok, "not measured yet"};
    }
    const auto seen = wanted > 0 ? fmt::format("{:.2f} Hz, wanted {:.2f}", measured, wanted)
                                 : fmt::format("{:.2f} Hz", measured);
    const double lowest = wanted > 0 ? wanted * (1 - speed_tolerance) : slowest_plausible_hz;
    const double highest = wanted > 0 ? wanted * (1 + speed_tolerance) : fastest_plausible_hz;
    if (measured < lowest) {
        return {
            Step::speed,
            Verdict::warning,
            seen,
            fmt::format("the lidar turns too slowly: {}", seen),
            {"its motor gets too little voltage",
             "the head turns stiffly: hair, dust, a worn bearing or belt"},
            {std::string(supply_advice),
             "take the power away and turn the head by hand: it must turn easily"}};
    }
    if (measured > highest) {
        return {
            Step::speed,
            Verdict::warning,
            seen,
            fmt::format("the lidar turns too fast: {}", seen),
            {"its motor hangs on the full supply, and not on what should regulate it"},
            {"take the adapter board that came with the lidar, or lower the duty on its motor "
             "pin"}};
    }
    if (!rotation.warning.empty()) {
        return {Step::speed, Verdict::warning, seen, rotation.warning, {}, {}};
    }
    return {Step::speed, Verdict::ok, seen};
}

}  // namespace sweepcast::diagnosis
