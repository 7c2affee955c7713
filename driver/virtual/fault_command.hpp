// Fault commands: what a virtual lidar that runs can be told to suffer, as users write it.
#pragma once

#include "driver/protocol/result.hpp"
#include "driver/virtual/emulator.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

namespace sweepcast::virtual_lidar {

/// It is pulled out: its port is gone, and it has no power.
struct Unplug {
    bool operator==(const Unplug&) const = default;
};

/// It is plugged in again: it boots, at a new port.
struct Replug {
    std::string link{};  ///< path of the link to its port; empty: as before
    bool operator==(const Replug&) const = default;
};

/// A fault begins, or its value changes.
struct SetFault {
    std::string text;  ///< as add_fault() takes it
    bool operator==(const SetFault&) const = default;
};

/// A fault ends.
struct ClearFault {
    std::string name{};  ///< empty: all of them
    bool operator==(const ClearFault&) const = default;
};

/// Something happens once.
struct Suffer {
    Incident incident{};
    std::uint32_t value{};
    bool operator==(const Suffer&) const = default;
};

using FaultCommand = std::variant<Unplug, Replug, SetFault, ClearFault, Suffer>;

/// What a command has at most.
inline constexpr std::size_t longest_fault_command = 1024;

/// Reads "unplug", "replug", "replug LINK_PATH" (to the end of the text), "fault NAME",
/// "fault NAME=VALUE", "clear", "clear NAME", "banner", "reboot", "protection-stop[=CODE]",
/// "half-answer", "angle-restart" or "loss[=BYTES]". Spaces round the words do not matter. What is
/// read can be obeyed as far as its text goes. Errors: errc::invalid_option.
[[nodiscard]] Result<FaultCommand, Problem> parse_fault_command(std::string_view text);

/// The command as parse_fault_command() reads it.
[[nodiscard]] std::string to_text(const FaultCommand& command);

/// The commands, for help texts: a line each.
[[nodiscard]] std::string fault_commands_help();

}  // namespace sweepcast::virtual_lidar
