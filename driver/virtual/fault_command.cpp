#include "driver/virtual/fault_command.hpp"

#include "driver/protocol/printable.hpp"
#include "driver/virtual/error.hpp"
#include "driver/virtual/faults.hpp"
#include "driver/virtual/trimmed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace {

// What may follow the name of an incident.
enum class Value : std::uint8_t { none, code, bytes };

struct IncidentName {
    std::string_view name;
    Incident incident;
    Value value;
    std::string_view form;
    std::string_view what;
};

constexpr std::uint32_t usual_loss = 10;
constexpr std::uint32_t most_loss = 1'000'000;

constexpr std::array incidents{
    IncidentName{
        "banner",
        Incident::banner,
        Value::none,
        "banner",
        "prints its boot text once, in the midst of a packet if it scans"},
    IncidentName{
        "reboot",
        Incident::reboot,
        Value::none,
        "reboot",
        "loses its power for a moment; its port stays"},
    IncidentName{
        "protection-stop",
        Incident::protection_stop,
        Value::code,
        "protection-stop[=CODE]",
        "stops the scan and reports an error, until RESET"},
    IncidentName{
        "half-answer",
        Incident::half_answer,
        Value::none,
        "half-answer",
        "of the next answer sends the first half only"},
    IncidentName{
        "angle-restart",
        Incident::angle_restart,
        Value::none,
        "angle-restart",
        "finds its angle reference anew, in the midst of a scan"},
    IncidentName{
        "loss",
        Incident::loss,
        Value::bytes,
        "loss[=BYTES]",
        "the next bytes (10) that it sends are lost"},
};

// Returns the beginning of a command from anywhere, for a problem that quotes it.
std::string shown(std::string_view text) {
    constexpr std::size_t most = 64;
    return protocol::printable_start(text, most, "...");
}

Problem not_a_command(std::string_view text) {
    std::string known = "unplug, replug [LINK_PATH], fault NAME[=VALUE], clear [NAME]";
    for (const auto& incident : incidents) {
        known += ", ";
        known += incident.form;
    }
    return {
        errc::invalid_option,
        fmt::format("there is no command \"{}\"", shown(text)),
        "known commands: " + known};
}

Problem malformed(std::string_view text, std::string_view form, std::string hint) {
    return {
        errc::invalid_option,
        fmt::format("the command \"{}\" is not of the form {}", shown(text), form),
        std::move(hint)};
}

Result<FaultCommand, Problem> parse_fault(std::string_view text, std::string_view rest) {
    if (rest.empty()) {
        return malformed(text, "fault NAME[=VALUE]", "for example: fault noise=0.02");
    }
    Faults scratch;
    if (auto added = add_fault(scratch, rest); !added) {
        return std::move(added).error();
    }
    return SetFault{std::string(rest)};
}

Result<FaultCommand, Problem> parse_clear(std::string_view rest) {
    Faults scratch;
    if (!rest.empty()) {
        if (auto cleared = clear_fault(scratch, rest); !cleared) {
            return std::move(cleared).error();
        }
    }
    return ClearFault{std::string(rest)};
}

// The value that an incident has when none is given, or the one that `text` says; none if it makes
// no sense.
std::optional<std::uint32_t> value_of(Value kind, std::optional<std::string_view> text) {
    switch (kind) {
    case Value::none:
        return text ? std::nullopt : std::optional(0U);
    case Value::code:
        return text ? parse_health_code(*text) : std::optional(usual_health_code);
    case Value::bytes: {
        std::uint32_t count = usual_loss;
        if (text) {
            const auto* const end = text->data() + text->size();
            const auto [stop, failure] = std::from_chars(text->data(), end, count);
            if (failure != std::errc{} || stop != end || count < 1 || count > most_loss) {
                return std::nullopt;
            }
        }
        return count;
    }
    }
    return std::nullopt;
}

Result<FaultCommand, Problem> parse_incident(std::string_view text) {
    const auto equals = text.find('=');
    const auto* const found =
        std::ranges::find(incidents, text.substr(0, equals), &IncidentName::name);
    if (found == incidents.end()) {
        return not_a_command(text);
    }
    const auto given =
        equals == std::string_view::npos ? std::nullopt : std::optional(text.substr(equals + 1));
    const auto value = value_of(found->value, given);
    if (!value) {
        return malformed(
            text,
            found->form,
            "a CODE is 0 to 65535, or hex such as 0x8001; BYTES is 1 to 1000000"
        );
    }
    return Suffer{found->incident, *value};
}

struct ToText {
    std::string operator()(const Unplug& /*command*/) const { return "unplug"; }
    std::string operator()(const Replug& command) const {
        return command.link.empty() ? "replug" : "replug " + command.link;
    }
    std::string operator()(const SetFault& command) const { return "fault " + command.text; }
    std::string operator()(const ClearFault& command) const {
        return command.name.empty() ? "clear" : "clear " + command.name;
    }
    std::string operator()(const Suffer& command) const {
        const auto* const found =
            std::ranges::find(incidents, command.incident, &IncidentName::incident);
        return found->value == Value::none ? std::string(found->name)
                                           : fmt::format("{}={}", found->name, command.value);
    }
};

}  // namespace

Result<FaultCommand, Problem> parse_fault_command(std::string_view text) {
    text = trimmed(text);
    if (text.size() > longest_fault_command) {
        return malformed(text, "COMMAND", "a command has at most 1024 bytes");
    }
    const auto end = std::min(text.find_first_of(blanks), text.size());
    const auto word = text.substr(0, end);
    const auto rest = trimmed(text.substr(end));
    if (word == "replug") {
        return Replug{std::string(rest)};
    }
    if (word == "fault") {
        return parse_fault(text, rest);
    }
    if (word == "clear") {
        return parse_clear(rest);
    }
    if (word == "unplug") {
        return rest.empty() ? Result<FaultCommand, Problem>(Unplug{})
                            : malformed(text, "unplug", "nothing follows it");
    }
    return parse_incident(text);
}

std::string to_text(const FaultCommand& command) {
    return std::visit(ToText{}, command);
}

std::string fault_commands_help() {
    constexpr std::string_view line = "  {:<24} {}\n";
    std::string help;
    help += fmt::format(line, "unplug", "its port and link vanish, and it loses its power");
    help += fmt::format(
        line,
        "replug [LINK_PATH]",
        "it boots at a new port, linked as before or there"
    );
    help += fmt::format(line, "fault NAME[=VALUE]", "begins one of the faults above");
    help += fmt::format(line, "clear [NAME]", "ends that fault, or all");
    for (const auto& incident : incidents) {
        help += fmt::format(line, incident.form, incident.what);
    }
    return help;
}

}  // namespace sweepcast::virtual_lidar
