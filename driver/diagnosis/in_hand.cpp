// The diagnosis of a lidar that is in hand: its state says what an examination would have to find
// out.
#include "driver/diagnosis/answer_findings.hpp"
#include "driver/diagnosis/diagnose.hpp"
#include "driver/diagnosis/scan_findings.hpp"

#include <fmt/format.h>

#include <variant>

namespace sweepcast::diagnosis {

namespace {

using device::DeviceState;
using device::Phase;

void add_port(const DeviceState& state, const link::LinkUrl& url, DiagnosisBuilder& builder) {
    if (std::holds_alternative<link::SerialPlace>(url.where)) {
        builder.add({Step::port, Verdict::ok, std::get<link::SerialPlace>(url.where).path});
        builder.add({Step::permission, Verdict::ok, "the gateway has it open"});
        builder.add({Step::holder, Verdict::ok, "the gateway's alone"});
    }
    builder.add({Step::open, Verdict::ok, "the gateway has it open"});
    const auto baud = state.line.baud;
    builder.add(
        {Step::bytes,
         Verdict::ok,
         baud > 0 ? fmt::format("an answer at {} baud", baud) : "an answer"}
    );
    builder.add({Step::descriptor, Verdict::ok, "it answered when the gateway met it"});
}

/// What a running scan tells. Returns false if something failed.
bool add_scan(const DeviceState& state, DiagnosisBuilder& builder) {
    const auto* mode = device::find_mode(state.modes, state.mode);
    QualityLook quality;
    quality.type = mode != nullptr ? mode->answer_type : protocol::AnswerType::normal;
    quality.line = state.line;
    const bool turns = state.rotation.measured_hz > 0;
    const auto seen = turns ? fmt::format("{:.2f} revolutions a second", state.rotation.measured_hz)
                            : std::string("the first are on their way");
    return builder.add({Step::motor, Verdict::ok, "samples come, in mode " + state.mode}) &&
           builder.add({Step::sweep, Verdict::ok, seen}) && builder.add(judge_quality(quality)) &&
           builder.add(judge_speed(state.rotation));
}

}  // namespace

Diagnosis diagnosis_of(const DeviceState& state, const link::LinkUrl& url) {
    DiagnosisBuilder builder(url.text, {});
    add_port(state, url, builder);
    const bool well = builder.add(judge_info(state.info, state.alias)) &&
                      (!state.health || builder.add(judge_health(*state.health))) &&
                      builder.add(judge_modes(state.modes));
    if (well && state.phase == Phase::scanning) {
        add_scan(state, builder);
    }
    return builder.finish();
}

}  // namespace sweepcast::diagnosis
